// Start-up of plane Poiseuille flow between two walls [Morris 1997] against the series: what no slip, the viscous force
// at a wall and hourglass control are worth together.

#include "bench/cases/poiseuille.h"

#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <vector>

namespace smelt {
namespace {

using namespace poiseuille;

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
