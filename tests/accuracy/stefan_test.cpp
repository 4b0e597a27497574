// A melting front: a solid at its melting point on a hot wall, one phase, against Neumann's similarity solution.

#include "tests/accuracy/measure.h"
#include "tests/accuracy/tank.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace smelt {
namespace {

constexpr double diffusivity = 1.0, density = 1000.0, melting = 300.0, hotter = 1.0;

/// A column 1 m high on a wall that is one kelvin hotter, six particles wide and repeating sideways; nothing moves.
Solver<2, double> make_column(double spacing, double stefan_number, double jitter) {
  const double width = 6.0 * spacing;
  Box<2> box;
  box.lower = Vec<2>::Zero();
  box.upper = Vec<2>(width, 1.0);
  Particles<2> p = make_block<2>(box, spacing, density, jitter);
  p.temperature.assign(p.size(), melting);
  auto parameters = make_parameters<2>(spacing, 1e-3);
  parameters.period.lower = Vec<2>(0.0, 0.0);
  parameters.period.upper = Vec<2>(width, -1.0);
  Material m = inviscid_material(density);
  m.heat = HeatProperties{diffusivity, melting, melting};
  m.heat->specific_heat = 1.0;
  m.heat->latent_heat = hotter / stefan_number;
  Obstacle<2> floor = make_wall({Vec<2>(-1.0, 0.0), Vec<2>(1.0 + width, 0.0)});
  std::swap(floor.facets[0][0], floor.facets[0][1]);
  floor.temperature = melting + hotter;
  Colliders<2> colliders;
  colliders.add(std::move(floor));
  return {parameters, {m}, std::move(colliders), std::move(p)};
}

/// Height at which the melted fraction, averaged over rows, crosses one half [m].
double front_of(const Solver<2, double>& solver, double spacing) {
  std::map<long, std::pair<double, int>> rows;
  for (std::size_t i = 0; i < solver.particles().size(); ++i) {
    auto& [sum, n] = rows[std::lround(std::floor(solver.particles().position[i][1] / spacing))];
    sum += solver.melted_fraction_of(i);
    ++n;
  }
  double below = 1.0, height = 0.0;
  for (const auto& [row, value] : rows) {
    const double y = (static_cast<double>(row) + 0.5) * spacing;
    const double melted = value.first / value.second;
    if (melted < 0.5) return height + (below - 0.5) / (below - melted) * (y - height);
    below = melted;
    height = y;
  }
  return 1.0;
}

/// Largest error of the front over the reference's times with a front from a quarter to `farthest` of the column [-].
double front_error(double spacing, double stefan_number, double jitter, double farthest) {
  const Reference reference = read_reference(fmt::format("stefan_front_Ste{:.1f}", stefan_number));
  Solver<2, double> solver = make_column(spacing, stefan_number, jitter);
  solver.prepare();
  double time = 0.0, worst = 0.0;
  int n = 0;
  for (std::size_t k = 0; k < reference.column[0].size(); ++k) {
    const double exact = reference.column[1][k];
    if (exact < 0.25 || exact > farthest) continue;
    advance_by(solver, reference.column[0][k] - time, time);
    time = reference.column[0][k];
    worst = std::max(worst, std::abs(front_of(solver, spacing) / exact - 1.0));
    ++n;
  }
  CHECK_GT(n, 1);
  return worst;
}

TEST(Stefan, FrontOfAMeltingSolid) {
  const double finest = full_run() ? 1.0 / 80.0 : 1.0 / 40.0;
  for (const double stefan_number : {0.1, 0.5, 2.0}) {
    const double farthest = stefan_number < 0.2 ? 0.4 : 0.65;
    std::vector<double> spacing, error;
    for (const double coarser : {4.0, 2.0, 1.0}) {
      spacing.push_back(coarser * finest);
      error.push_back(front_error(spacing.back(), stefan_number, 0.0, farthest));
    }
    report_row({.problem = fmt::format("Stefan front; Ste = {}", stefan_number),
                .quantity = "front / exact - 1; max over times",
                .resolution = fmt::format("{:.0f} to {:.0f} in the column", 1.0 / spacing.front(), 1.0 / spacing.back()),
                .error = error.back(),
                .bar = 0.02,
                .order = convergence_order(spacing, error)});
    report_row({.problem = fmt::format("Stefan front; Ste = {}", stefan_number),
                .quantity = "front / exact - 1; max over times (jitter 0.1)",
                .resolution = fmt::format("{:.0f} in the column", 1.0 / finest),
                .error = front_error(finest, stefan_number, 0.1, farthest),
                .bar = 0.02});
  }
}

}  // namespace
}  // namespace smelt
