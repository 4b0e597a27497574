#include "scenes/check_scene.h"

#include "core/error.h"
#include "scenes/advise.h"
#include "scenes/build_simulation.h"

#include <chrono>
#include <cmath>

namespace smelt {

namespace {

template <typename Real>
void take_trial_steps(const Scene& scene, SimulationSetup& setup, int n_trial_steps, SceneForecast& forecast) {
  SolverParameters<3> parameters = setup.parameters;
  parameters.min_time_step = 0.0;  // a floor too high is something to advise on, not to stop at
  Solver<3, Real> solver(parameters, setup.materials, build_colliders(setup), std::move(setup.particles));
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
  forecast.simulate_seconds = forecast.n_steps * seconds / n_steps;

  const auto& particles = solver.particles();
  double state_bytes = 0.0;
  for_each_array(particles, [&](const auto& values) {
    if (!values.empty()) state_bytes += static_cast<double>(values.size() * sizeof(values[0]));
  });
  const double n = static_cast<double>(particles.size());
  const double pass_bytes = n * (PairFields<3, Real>::motion_stride + PairFields<3, Real>::force_stride(true) + 3.0) * sizeof(Real) +
                            n * sizeof(RateSums<3, Real>) + 3.0 * n * sizeof(Vec3);
  const double list_bytes = static_cast<double>(solver.neighbours().index.size()) * sizeof(std::int32_t) + 16.0 * n;
  // A neighbour search and a sort hold a second copy for a moment.
  forecast.bytes = state_bytes + pass_bytes + 2.0 * list_bytes;
}

}  // namespace

SceneForecast forecast_scene(const Scene& scene, int n_trial_steps) {
  SimulationSetup setup = build_simulation(scene);
  SceneForecast forecast;
  forecast.n_particles = setup.particles.size();
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
