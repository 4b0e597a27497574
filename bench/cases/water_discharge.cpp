#include "bench/cases/water_discharge.h"

#include "bench/cases/cpu_clock.h"
#include "bench/cases/draw.h"
#include "bench/cases/tank.h"
#include "core/error.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace smelt::water_discharge {

namespace {

constexpr double width = 0.146, height = 2.0 * width, opening = width / 3.0;

Colliders<2> make_vessel() {
  constexpr double lip = 0.5 * opening, top = 1.5 * height;
  return make_colliders({{Vec<2>(width - lip, -2.0 * lip), Vec<2>(width, 0.0), Vec<2>(0.0, 0.0), Vec<2>(0.0, top)},
                         {Vec<2>(width, top), Vec<2>(width, opening), Vec<2>(width + lip, opening + 2.0 * lip),
                          Vec<2>(width + lip, top)}});
}

/// A column under the pressure of its weight, in the vessel.
Solver<2, double> make_solver(double spacing) {
  auto parameters = make_water_parameters(spacing, height, 0.02);
  parameters.equation_of_state.law = PressureLaw::tait;
  Particles<2> column = make_block<2>({Vec<2>(0.0, 0.0), Vec<2>(width, height)}, spacing, water_density);
  for (std::size_t i = 0; i < column.size(); ++i)
    column.density[i] = density_at_pressure(PressureLaw::tait, parameters.sound_speed,
                                            water_density * gravity * (height - column.position[i][1]));
  return {parameters, {inviscid_material(water_density)}, make_vessel(), std::move(column)};
}

/// What is left in the vessel, as a height [m].
double level_of(const Particles<2>& p, double spacing) {
  const auto within = std::count_if(p.position.begin(), p.position.end(), [](const Vec<2>& x) { return x[0] < width; });
  return static_cast<double>(within) * spacing * spacing / width;
}

/// Adds the particles of the jet, under a level [m] that sinks [m/s], to the sums.
void observe(const Particles<2>& p, double level, double sinking, Jet& jet) {
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec<2>& x = p.position[i];
    if (x[0] < width + opening || x[0] > width + 2.0 * opening) continue;
    const double torricelli = std::sqrt(2.0 * gravity * (level - x[1]) + sinking * sinking);
    jet.speed += p.velocity[i].norm();
    jet.torricelli += torricelli;
    jet.fastest = std::max(jet.fastest, p.velocity[i].norm() / torricelli);
    ++jet.n;
  }
}

Measurement run_case(std::size_t, double n_across) {
  const CpuClock clock;
  const Jet jet = discharge(static_cast<int>(n_across));
  Measurement measured{.error = std::abs(jet.speed / jet.torricelli - 1.0),
                       .cpu_seconds = clock.seconds(),
                       .n_particles = jet.particles.size()};
  measured.picture = draw_speeds(jet.particles, "The vessel after 0.3 s: the jet leaves to the right.");
  return measured;
}

}  // namespace

Jet discharge(int n_across) {
  const double spacing = width / n_across;
  Solver<2, double> solver = make_solver(spacing);
  solver.prepare();
  constexpr double interval = 0.01;
  Jet jet;
  std::vector<double> levels{level_of(solver.particles(), spacing)};
  for (int k = 1; k <= 30; ++k) {
    advance_by(solver, interval, (k - 1) * interval);
    const auto& p = solver.particles();
    levels.push_back(level_of(p, spacing));
    for (const Vec<2>& x : p.position) jet.leaked += x[0] < 0.0 || (x[1] < -1e-9 && x[0] < 0.75 * width);
    if (k * interval < 0.2 - 0.5 * interval) continue;  // the jet forms
    observe(p, levels.back(), (levels[static_cast<std::size_t>(k) - 5] - levels.back()) / (5.0 * interval), jet);
  }
  CHECK_GT(jet.n, 0);
  jet.speed /= jet.n;
  jet.torricelli /= jet.n;
  jet.particles = solver.particles();
  return jet;
}

Case make_case() {
  return {
      .name = "water_discharge",
      .title = "Water discharge",
      .measures =
          "The speed of the jet that runs out of a vessel at its floor, mean from 0.2 to 0.3 s, against Torricelli's.",
      .good = "Within 5 %; with the text's 24 particles across, eight across the opening.",
      .good_errors = {0.05},
      .error_label = "|speed of the jet / Torricelli's - 1|",
      .resolution_label = "particles across the vessel",
      .methods = {"continuity density"},
      .quick = {18, 24, 36},
      .full = {18, 24, 36, 48, 72},
      .run = run_case};
}

}  // namespace smelt::water_discharge
