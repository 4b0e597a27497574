#include "scenes/advise.h"

#include "core/sph/rheology.h"
#include "scenes/expected_speed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

using Advice = std::vector<std::string>;

void advise_on_sound_speed(const SimulationSetup& setup, Advice& advice) {
  const ExpectedSpeed expected = expect_speed(setup);
  const double c = setup.parameters.sound_speed, v = expected.speed;
  // Without gravity and start nothing says how fast it will get.
  if (!(v > 0.0)) return;
  if (c < 5.0 * v)
    advice.push_back(fmt::format(
        "[solver] sound_speed_m_s = {:.4g} is only {:.2g} times the fastest speed expected, {:.3g} m/s ({}): the "
        "density may err by {:.0f} %; choose {:.3g} for 1 %",
        c, c / v, v, expected.reason, 100.0 * v * v / (c * c), 10.0 * v));
  if (c > 30.0 * v)
    advice.push_back(fmt::format(
        "[solver] sound_speed_m_s = {:.4g} is {:.0f} times the fastest speed expected, {:.3g} m/s ({}), and makes the "
        "shot {:.1f} times as long as {:.3g} would, at which the density errs by 1 %",
        c, c / v, v, expected.reason, c / (10.0 * v), 10.0 * v));
}

void advise_on_relaxed_stress(const SimulationSetup& setup, Advice& advice) {
  const SolverParameters<3>& p = setup.parameters;
  const double c_s = p.shear_wave_speed;
  if (!(c_s > 0.0)) return;
  const double g = p.gravity.norm();
  const double height = g > 0.0 ? setup.body_bounds.extent().dot(p.gravity.cwiseAbs()) / g : 0.0;
  const double strain = g * height / (c_s * c_s);
  if (strain > 0.05)
    advice.push_back(fmt::format(
        "[solver] shear_wave_speed_m_s = {:.4g} is soft: a solid as tall as the bodies, {:.3g} m, would sag by {:.0f} "
        "% under its own weight at once; choose at least {:.3g} for 2 %",
        c_s, height, 100.0 * strain, std::sqrt(g * height / 0.02)));
}

void advise_on_viscosity(const SimulationSetup& setup, Advice& advice) {
  const SolverParameters<3>& p = setup.parameters;
  if (p.shear_wave_speed > 0.0) return;
  const double h = p.smoothing_length;
  const double acoustic = p.courant * h / p.sound_speed;
  for (const Material& m : setup.materials) {
    double nu = 0.0;
    for (const double u : {0.0, 1.0}) {
      const double temperature = m.heat ? (u == 0.0 ? m.heat->cold : m.heat->hot) : 0.0;
      nu = std::max(nu, viscosity(flow_curve_at(m.rheology, u, temperature), 0.0) / m.density);
    }
    const double viscous = nu > 0.0 ? p.courant * h * h / (8.0 * nu) : acoustic;
    if (viscous < 0.05 * acoustic)
      advice.push_back(fmt::format(
          "material \"{}\": its viscosity at rest, {:.3g} Pa s, holds the time step at {:.2g} s, {:.3g} times less "
          "than sound does; choose [solver] shear_wave_speed_m_s = {:.3g}, with which any viscosity is stable",
          m.name, nu * m.density, viscous, acoustic / viscous, p.sound_speed));
  }
}

}  // namespace

std::vector<std::string> advise(const SimulationSetup& setup, double time_step) {
  Advice advice;
  advise_on_sound_speed(setup, advice);
  advise_on_relaxed_stress(setup, advice);
  advise_on_viscosity(setup, advice);
  if (const double floor = setup.parameters.min_time_step; time_step < 10.0 * floor)
    advice.push_back(fmt::format(
        "[time_step] min_s = {:.3g} {} the first step, {:.3g} s, so the shot {} stop as diverged; choose {:.1g}", floor,
        time_step < floor ? "is above" : "is hardly below", time_step, time_step < floor ? "will" : "may",
        time_step / 1000.0));
  return advice;
}

}  // namespace smelt
