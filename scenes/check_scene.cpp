#include "scenes/check_scene.h"

#include "core/error.h"
#include "scenes/advise.h"
#include "scenes/build_simulation.h"

#include <chrono>
#include <cmath>
#include <numbers>

namespace smelt {

namespace {

/// Something to measure the pace with where nothing is there at the start: a cube of what the first vent pours, that flies on.
Particles<3> make_trial_block(const SimulationSetup& setup, double n_wanted) {
  const Emitter<3>& e = setup.parameters.emitters.front();
  const int n = std::max(2, static_cast<int>(std::cbrt(n_wanted)));
  Particles<3> p;
  for (int k = 0; k < n * n * n; ++k) {
    p.id.push_back(k);
    if (setup.materials.size() > 1) p.material.push_back(e.material);
    p.position.push_back(e.position + setup.spacing * Vec3(k % n, k / n % n, k / (n * n)));
    p.velocity.push_back(e.flow_rate / (std::numbers::pi * e.radius * e.radius) * e.direction);
    p.density.push_back(setup.materials[e.material].density);
    if (setup.materials[e.material].heat) p.temperature.push_back(e.temperature);
  }
  return p;
}

/// Mean over the shot of the number of particles, over that at the trial.
double mean_growth(const Scene& scene, const SimulationSetup& setup, double n_start, double n_trial) {
  double sum = 0.0;
  for (int frame = 0; frame < scene.shot.frames; ++frame) sum += n_start + count_poured(setup, frame / scene.shot.fps);
  return sum / scene.shot.frames / n_trial;
}

template <typename Real>
void take_trial_steps(const Scene& scene, SimulationSetup& setup, int n_trial_steps, SceneForecast& forecast) {
  SolverParameters<3> parameters = setup.parameters;
  parameters.min_time_step = 0.0;  // a floor too high is something to advise on, not to stop at
  Colliders<3> colliders;
  Particles<3> particles = setup.particles;
  const double n_start = static_cast<double>(particles.size()), n_end = static_cast<double>(forecast.n_particles_end);
  if (particles.size() > 0) {
    colliders = build_colliders(setup);
  } else {
    constexpr double enough = 10000.0;
    particles = make_trial_block(setup, std::min(n_end, enough));
    parameters.emitters.clear();
    parameters.outflows.clear();
    parameters.domain = {};
  }
  const double n_trial = static_cast<double>(particles.size());
  Solver<3, Real> solver(parameters, setup.materials, std::move(colliders), std::move(particles));
  solver.prepare();
  double remaining = 1.0 / scene.shot.fps;
  const auto start = std::chrono::steady_clock::now();
  int n_steps = 0;
  for (; n_steps < n_trial_steps && remaining > 0.0; ++n_steps) {
    const TimeStep step = solver.step(remaining, 1.0 / scene.shot.fps - remaining);
    remaining -= step.dt;
    if (n_steps == 0) {
      forecast.time_step = step.dt;
      forecast.time_step_term = time_step_term_names[static_cast<std::size_t>(step.term)];
    }
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  forecast.n_steps = std::ceil((scene.shot.frames - 1) / scene.shot.fps / forecast.time_step);
  forecast.simulate_seconds = forecast.n_steps * seconds / n_steps * mean_growth(scene, setup, n_start, n_trial);

  const auto& state = solver.particles();
  double state_bytes = 0.0;
  for_each_array(state, [&](const auto& values) {
    if (!values.empty()) state_bytes += static_cast<double>(values.size() * sizeof(values[0]));
  });
  const double n = static_cast<double>(state.size());
  const double pass_bytes = n * (PairFields<3, Real>::stride_of(true) + 3.0) * sizeof(Real) +
                            n * sizeof(RateSums<3, Real>) + 3.0 * n * sizeof(Vec3);
  const auto list_bytes = static_cast<double>(solver.neighbours().n_bytes());
  forecast.bytes = (state_bytes + pass_bytes + list_bytes) * std::max(1.0, n_end / n);
}

}  // namespace

SceneForecast forecast_scene(const Scene& scene, int n_trial_steps) {
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
    take_trial_steps<double>(scene, setup, n_trial_steps, forecast);
  else
    take_trial_steps<float>(scene, setup, n_trial_steps, forecast);
  forecast.advice = advise(setup, forecast.time_step);
  return forecast;
}

}  // namespace smelt
