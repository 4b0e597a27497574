#include "core/sph/time_step.h"

#include <cmath>

namespace smelt {

TimeStep compute_time_step(const TimeStepInput& input, double courant) {
  const double h = input.smoothing_length;
  TimeStep step{courant * h / (input.max_speed + input.wave_speed), TimeStepTerm::acoustic};
  const auto limit = [&](double dt, TimeStepTerm term) {
    if (dt < step.dt) step = {dt, term};
  };
  if (input.max_kinematic_viscosity > 0.0)
    limit(courant * h * h / (8.0 * input.max_kinematic_viscosity), TimeStepTerm::viscous);
  if (input.max_acceleration > 0.0) limit(courant * std::sqrt(h / input.max_acceleration), TimeStepTerm::acceleration);
  if (input.max_diffusivity > 0.0) limit(h * h / (8.0 * input.max_diffusivity), TimeStepTerm::conduction);
  if (input.density_diffusivity > 0.0)
    limit(h * h / (6.0 * input.density_diffusivity), TimeStepTerm::density_diffusion);
  return step;
}

TimeStep fit_to_frame(const TimeStep& step, double remaining) {
  if (step.dt >= remaining) return {remaining, TimeStepTerm::frame_end};
  if (2.0 * step.dt > remaining) return {0.5 * remaining, TimeStepTerm::frame_end};
  return step;
}

}  // namespace smelt
