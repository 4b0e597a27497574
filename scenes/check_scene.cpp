#include "scenes/check_scene.h"

#include "core/error.h"
#include "core/geometry/triangle_mesh.h"
#include "io/atomic_file.h"
#include "io/particles_vdb.h"
#include "io/surface_vdb.h"
#include "scenes/advise.h"
#include "scenes/build_simulation.h"
#include "scenes/build_view.h"
#include "scenes/machine_pace.h"
#include "scenes/solver_frame.h"
#include "scenes/surface_files.h"

#include <tbb/global_control.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <thread>
#include <unistd.h>

namespace smelt {

namespace {

void add_poured(const SimulationSetup& setup, const Vec3& position, Particles<3>& particles) {
  const Emitter<3>& e = setup.parameters.emitters.front();
  particles.id.push_back(static_cast<std::int32_t>(particles.id.size()));
  if (setup.materials.size() > 1) particles.material.push_back(e.material);
  particles.position.push_back(position);
  particles.velocity.push_back(0.5 * e.flow_rate / (std::numbers::pi * e.radius * e.radius) * Vec3::UnitX());
  particles.density.push_back(setup.materials[e.material].density);
  if (setup.materials[e.material].heat) particles.temperature.push_back(e.temperature);
}

/// Where a line straight down from `start` comes within half a spacing of an obstacle, above `lowest`.
std::optional<Vec3> find_ground(const Colliders<3>& colliders, Vec3 start, double lowest, double spacing) {
  for (; start.y() > lowest;
       start.y() -= std::max(0.1 * spacing, colliders.clearance(start, 100.0 * spacing) - 0.5 * spacing))
    if (colliders.clearance(start, spacing) <= 0.6 * spacing) return start;
  return std::nullopt;
}

/// Something to measure the pace with where nothing is there at the start: a layer of what the first vent pours, four
/// particles thick, on the ground around it, as most of a flow comes to lie; or a cube of it where there is no ground.
Particles<3> make_trial_particles(const SimulationSetup& setup, const Colliders<3>& colliders, double n_wanted) {
  constexpr int n_layers = 4;
  const Emitter<3>& e = setup.parameters.emitters.front();
  Box3 bounds;
  for (const TriangleMesh& mesh : setup.colliders) {
    const Box3 box = compute_bounds(mesh);
    bounds.extend(box.lower);
    bounds.extend(box.upper);
  }
  Particles<3> p;
  const int half = std::max(1, static_cast<int>(0.5 * std::sqrt(n_wanted / n_layers)));
  const double top = std::max(bounds.upper.y(), e.position.y()) + setup.spacing;
  for (int i = -half; i < half && !setup.colliders.empty(); ++i)
    for (int j = -half; j < half; ++j) {
      const Vec3 above(e.position.x() + (i + 0.5) * setup.spacing, top, e.position.z() + (j + 0.5) * setup.spacing);
      const auto ground = find_ground(colliders, above, bounds.lower.y(), setup.spacing);
      for (int layer = 0; ground && layer < n_layers; ++layer)
        add_poured(setup, *ground + layer * setup.spacing * Vec3::UnitY(), p);
    }
  if (p.size() > 0) return p;
  const int n = std::max(2, static_cast<int>(std::cbrt(n_wanted)));
  for (int k = 0; k < n * n * n; ++k)
    add_poured(setup, e.position + setup.spacing * Vec3(k % n, k / n % n, k / (n * n)), p);
  return p;
}

/// Mean over the shot of the number of particles, over that at the trial.
double mean_growth(const Scene& scene, const SimulationSetup& setup, double n_start, double n_trial) {
  double sum = 0.0;
  for (int frame = 0; frame < scene.shot.frames; ++frame) sum += n_start + count_poured(setup, frame / scene.shot.fps);
  return sum / scene.shot.frames / n_trial;
}

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A folder that goes when it is done with.
struct TrialFolder {
  OutputFolder folder{std::filesystem::temp_directory_path() / fmt::format("smelt_check_{}", ::getpid())};

  TrialFolder() {
    create_directories_or_fail(folder.particles());
    create_directories_or_fail(folder.surfaces());
  }
  ~TrialFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(folder.root, ignored);
  }
};

/// What the surfaces of `particles` and pictures of them cost, with their files; `growth` as of the particles.
void forecast_pictures(const Scene& scene, const ParticleFrame& particles, double growth, SceneForecast& forecast) {
  const TrialFolder trial;
  write_particles(trial.folder.particles(1), particles);
  SurfaceMesh surface;
  forecast.surface_seconds =
      scene.shot.frames * growth * seconds_of([&] {
        surface = make_surface_files(trial.folder.particles(1), read_particles(trial.folder.particles(1)), scene,
                                     trial.folder, 1);
      });
  RenderScene view = build_view(scene);
  const int width = view.camera.width, height = view.camera.height;
  const auto time_picture = [&](int part) {
    view.camera.width = std::max(16, width / part);
    view.camera.height = std::max(16, height / part);
    return seconds_of([&] {
      surface = read_surface(trial.folder.surface_obj(1), trial.folder.surface_vdb(1));
      render_film(surface, view, to_options(scene.render), 1);
    });
  };
  // What a picture costs whatever its size, and what a pixel costs.
  const double small = time_picture(4), larger = time_picture(2);
  const double per_sixteenth = std::max(0.0, (larger - small) / 3.0);  // of the pixels
  forecast.render_seconds = scene.shot.frames * (small + 15.0 * per_sixteenth);
}

/// How much longer a step takes on average over a shot than at its start, where little moves: neighbours are searched
/// for more often, more particles are at walls. Measured on ten scenes: 1.1 to 2.2, this in the middle.
constexpr double activity = 1.45;

template <typename Real>
void take_trial_steps(const Scene& scene, SimulationSetup& setup, int n_trial_steps, bool with_pictures,
                      SceneForecast& forecast) {
  SolverParameters<3> parameters = setup.parameters;
  parameters.min_time_step = 0.0;  // a floor too high is something to advise on, not to stop at
  Colliders<3> colliders = build_colliders(setup);
  Particles<3> particles = setup.particles;
  const double n_start = static_cast<double>(particles.size()), n_end = static_cast<double>(forecast.n_particles_end);
  if (particles.size() == 0) {
    constexpr double enough = 10000.0;
    particles = make_trial_particles(setup, colliders, std::min(n_end, enough));
    parameters.emitters.clear();
    parameters.outflows.clear();
    parameters.domain = {};
  }
  const double n_trial = static_cast<double>(particles.size());
  Solver<3, Real> solver(parameters, setup.materials, std::move(colliders), std::move(particles));
  solver.prepare();
  double remaining = 1.0 / scene.shot.fps;
  constexpr int n_warm_up = 2;
  auto start = std::chrono::steady_clock::now();
  int n_steps = 0;
  for (; n_steps < n_warm_up + n_trial_steps && remaining > 0.0; ++n_steps) {
    const TimeStep step = solver.step(remaining, 1.0 / scene.shot.fps - remaining);
    remaining -= step.dt;
    if (n_steps == 0) {
      forecast.time_step = step.dt;
      forecast.time_step_term = time_step_term_names[static_cast<std::size_t>(step.term)];
    }
    // Of a frame of no more steps than the warm-up's, all count.
    if (n_steps + 1 == n_warm_up && remaining > 0.0) start = std::chrono::steady_clock::now();
  }
  const int n_timed = n_steps > n_warm_up ? n_steps - n_warm_up : n_steps;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double growth = mean_growth(scene, setup, n_start, n_trial);
  forecast.n_steps = std::ceil((scene.shot.frames - 1) / scene.shot.fps / forecast.time_step);
  forecast.simulate_seconds = activity * forecast.n_steps * seconds / n_timed * growth;
  if (with_pictures) {
    ParticleFrame frame = to_frame(solver, setup.spacing, 1, 0.0);
    if (scene.particles.rest_position)
      for (const Vec3& x : frame.position) frame.rest.push_back(x.cast<float>());
    forecast_pictures(scene, frame, growth, forecast);
  }

  const auto& state = solver.particles();
  double state_bytes = 0.0;
  for_each_array(state, [&](const auto& values) {
    if (!values.empty()) state_bytes += static_cast<double>(values.size() * sizeof(values[0]));
  });
  const double n = static_cast<double>(state.size());
  using Balance = HeatBalance<3, Real>;
  const double derived_bytes = 2.0 * PairFields<3, Real>::record_size * sizeof(Real) +
                               3.0 * sizeof(typename Solver<3, Real>::RealVec) + sizeof(Balance) + 4.0 * sizeof(double);
  const auto list_bytes = static_cast<double>(solver.neighbours().n_bytes());
  forecast.bytes = (state_bytes + n * derived_bytes + list_bytes) * std::max(1.0, n_end / n);
}

}  // namespace

SceneForecast forecast_scene(const Scene& scene, int n_trial_steps, bool with_pictures) {
  SimulationSetup setup = build_simulation(scene);
  SceneForecast forecast;
  forecast.n_particles = setup.particles.size();
  const double poured = count_poured(setup, (scene.shot.frames - 1) / scene.shot.fps);
  forecast.n_particles_end = forecast.n_particles + static_cast<std::size_t>(std::llround(poured));
  forecast.spacing = setup.spacing;
  forecast.body_volume = setup.body_volume;
  forecast.sound_speed = setup.parameters.sound_speed;
  forecast.warnings = setup.warnings;
  if (scene.solver.precision == "double")
    take_trial_steps<double>(scene, setup, n_trial_steps, with_pictures, forecast);
  else
    take_trial_steps<float>(scene, setup, n_trial_steps, with_pictures, forecast);
  // The calibration's work took all threads.
  const std::size_t n_threads = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  if (n_threads >= std::thread::hardware_concurrency()) forecast.load = measure_load();
  if (forecast.load)
    for (double* seconds : {&forecast.simulate_seconds, &forecast.surface_seconds, &forecast.render_seconds})
      *seconds /= *forecast.load;
  forecast.advice = advise(setup, forecast.time_step);
  return forecast;
}

}  // namespace smelt
