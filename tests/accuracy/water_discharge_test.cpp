// Water discharge [S 4.5.3.2]: a column L x 2L of 1152 particles runs out of its vessel, against Torricelli.
//
// The text's figure of the vessel is lost: here the opening is L/3 high, eight of [S]'s particles, in the side at the floor (L/4, six of
// them, leaves four across the jet, two of which are its edges: 6.9 % off). Its lips are sharp,
// so that the jet is free on either side, and past its narrowing the pressure is nought: with h the level and V =
// -dh/dt,
//   v^2 = 2 g (h - y) + V^2  (Bernoulli from the surface to a particle at height y).
// [S] sums density [S 4.20], with a quintic kernel; here as in every scene of this project: continuity, cubic spline.

#include "tests/accuracy/measure.h"
#include "tests/accuracy/tank.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace smelt {
namespace {

constexpr double width = 0.146, height = 2.0 * width, opening = width / 3.0;

Colliders<2> make_vessel() {
  constexpr double lip = 0.5 * opening, top = 1.5 * height;
  return make_colliders({{Vec<2>(width - lip, -2.0 * lip), Vec<2>(width, 0.0), Vec<2>(0.0, 0.0), Vec<2>(0.0, top)},
                         {Vec<2>(width, top), Vec<2>(width, opening), Vec<2>(width + lip, opening + 2.0 * lip),
                          Vec<2>(width + lip, top)}});
}

/// Sums over the particles of the jet from one to two openings beyond the lips, all times.
struct Jet {
  double speed = 0.0, torricelli = 0.0;  ///< [m/s], not yet divided by n
  double fastest = 0.0;                  ///< largest v / torricelli
  int n = 0;
};

void test_discharge(int n_across) {
  const double spacing = width / n_across;
  auto parameters = make_water_parameters(spacing, height, 0.02);
  parameters.equation_of_state.law = PressureLaw::tait;
  Particles<2> column = make_block<2>({Vec<2>(0.0, 0.0), Vec<2>(width, height)}, spacing, water_density);
  for (std::size_t i = 0; i < column.size(); ++i)
    column.density[i] = density_at_pressure(PressureLaw::tait, parameters.sound_speed,
                                            water_density * gravity * (height - column.position[i][1]));
  const std::size_t n_particles = column.size();
  Solver<2, double> solver(parameters, {inviscid_material(water_density)}, make_vessel(), std::move(column));
  solver.prepare();

  const auto level = [&] {
    std::size_t within = 0;
    for (const Vec<2>& x : solver.particles().position) within += x[0] < width ? 1 : 0;
    return static_cast<double>(within) * spacing * spacing / width;
  };
  constexpr double interval = 0.01;
  Jet jet;
  double leaked = 0.0;
  std::vector<double> levels{level()};
  for (int k = 1; k <= 30; ++k) {
    advance_by(solver, interval, (k - 1) * interval);
    levels.push_back(level());
    const auto& p = solver.particles();
    for (const Vec<2>& x : p.position) leaked += x[0] < 0.0 || (x[1] < -1e-9 && x[0] < 0.75 * width) ? 1.0 : 0.0;
    if (k * interval < 0.2 - 0.5 * interval) continue;  // the jet forms
    const double sinking = (levels[static_cast<std::size_t>(k) - 5] - levels.back()) / (5.0 * interval);
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Vec<2>& x = p.position[i];
      if (x[0] < width + opening || x[0] > width + 2.0 * opening) continue;
      const double torricelli = std::sqrt(2.0 * gravity * (levels.back() - x[1]) + sinking * sinking);
      jet.speed += p.velocity[i].norm();
      jet.torricelli += torricelli;
      jet.fastest = std::max(jet.fastest, p.velocity[i].norm() / torricelli);
      ++jet.n;
    }
  }
  const std::string resolution = fmt::format("{} particles", n_particles);
  ASSERT_GT(jet.n, 0);
  report_row({"water discharge", "speed of the jet over Torricelli's less 1; mean 0.2 to 0.3 s", resolution,
              std::abs(jet.speed / jet.torricelli - 1.0), 0.05});
  report_row(
      {"water discharge", "fastest particle of the jet over Torricelli's less 1", resolution, jet.fastest - 1.0, 0.3});
  report_row({"water discharge", "particles found behind walls", resolution, leaked, 0.0});
}

TEST(WaterDischarge, JetLeavesAtTorricellisSpeed) {
  test_discharge(24);
  test_discharge(36);
  if (full_run()) test_discharge(48);
}

}  // namespace
}  // namespace smelt
