// Start-up of plane Poiseuille flow between two walls [Morris 1997] against the series: what no slip, the viscous force
// at a wall and hourglass control are worth together.

#include "tests/accuracy/measure.h"
#include "tests/accuracy/set_up.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

namespace smelt {
namespace {

constexpr double width = 1e-3, kinematic_viscosity = 1e-6, density = 1000.0, body_force = 1e-4;
constexpr double peak = body_force * width * width / (8.0 * kinematic_viscosity);  // of the steady velocity [m/s]
constexpr std::array times{0.0225, 0.045, 0.1125, 0.225, 1.0};                     // one a column of the reference

struct Setting {
  double jitter = 0.0;  // of the lattice at the start, in spacings
  double hourglass_control = 1.0;
  bool wall = true;
};

/// A channel eight spacings long that repeats, between the two planes.
Solver<2, double> make_channel(int across, const Setting& setting) {
  const double spacing = width / across;
  auto parameters = make_parameters<2>(spacing, 10.0 * peak);
  parameters.smoothing_length = 1.3 * spacing;
  parameters.gravity = Vec<2>(body_force, 0.0);
  parameters.courant = 0.4;
  parameters.hourglass_control = setting.hourglass_control;
  parameters.period.lower = Vec<2>(0.0, 0.0);
  parameters.period.upper = Vec<2>(8.0 * spacing, 0.0);
  Obstacle<2> planes{
      {{Vec<2>(2.0 * width, 0.0), Vec<2>(-width, 0.0)}, {Vec<2>(-width, width), Vec<2>(2.0 * width, width)}}};
  planes.wall = setting.wall;
  Colliders<2> colliders;
  colliders.add(std::move(planes));
  const Box<2> channel{Vec<2>(0.0, 0.0), Vec<2>(8.0 * spacing, width)};
  return {parameters,
          {newtonian_material(density, density * kinematic_viscosity)},
          std::move(colliders),
          make_block<2>(channel, spacing, density, setting.jitter)};
}

/// sqrt(sum e^2 / sum u^2) over the particles, e what a velocity along the channel is off from column `c` of the
/// reference.
double relative_error(const Particles<2>& p, const Reference& reference, std::size_t c) {
  std::vector<double> differences, exact;
  for (std::size_t i = 0; i < p.size(); ++i) {
    exact.push_back(reference.at(p.position[i][1], c));
    differences.push_back(p.velocity[i][0] - exact.back());
  }
  return compute_norms(differences).l2 / compute_norms(exact).l2;
}

/// The error at each of the times.
std::array<double, times.size()> run_channel(int across, const Setting& setting) {
  const Reference reference = read_reference("poiseuille_startup");
  Solver<2, double> solver = make_channel(across, setting);
  solver.prepare();
  std::array<double, times.size()> errors{};
  double time = 0.0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    advance_by(solver, times[k] - time, time);
    time = times[k];
    errors[k] = relative_error(solver.particles(), reference, k + 1);
  }
  return errors;
}

TEST(Poiseuille, StartsUpAsTheSeries) {
  const auto ten = run_channel(10, {}), twenty = run_channel(20, {}), forty = run_channel(40, {});
  for (std::size_t k = 0; k < times.size(); ++k)
    report_row({.problem = fmt::format("Poiseuille flow from rest after {} s", times[k]),
                .quantity = "velocity L2 / L2 of the velocity",
                .resolution = "40 across",
                .error = forty[k],
                .bar = 0.01,
                .order = convergence_order(std::vector{0.1, 0.05, 0.025}, std::vector{ten[k], twenty[k], forty[k]}),
                .least_order = 1.5});
}

// Without a bar: what disorder costs.
TEST(Poiseuille, OnADisorderedLattice) {
  const auto errors = run_channel(40, {.jitter = 0.2});
  for (std::size_t k = 0; k < times.size(); ++k)
    report_row({.problem = fmt::format("Poiseuille flow from rest after {} s", times[k]),
                .quantity = "velocity L2 / L2 of the velocity (jitter 0.2 spacings)",
                .resolution = "40 across",
                .error = errors[k]});
}

// The corrected gradients do not see rows of the lattice that slide over each other.
TEST(Poiseuille, IsLostWithoutHourglassControl) {
  EXPECT_GT(run_channel(40, {.hourglass_control = 0.0}).back(), 0.1);
}

// No slip by collision alone [P 6.3] stops what touches a plane, and shears nothing.
TEST(Poiseuille, IsLostWithCollisionAlone) {
  EXPECT_GT(run_channel(40, {.wall = false}).back(), 0.1);
}

}  // namespace
}  // namespace smelt
