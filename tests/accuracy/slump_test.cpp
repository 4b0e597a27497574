// The slump of a Bingham cylinder under its own weight, 3D, against the formula of Pashias et al. (1996).

#include "bench/cases/slump.h"

#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace smelt {
namespace {

class Slump : public testing::TestWithParam<double> {};

TEST_P(Slump, BinghamCylinder) {
  constexpr int n = 16;
  const double expected = read_reference("bingham_slump_cylinder").at(GetParam());
  const double seen = slump::simulate_slump(GetParam(), n).slump;
  report_row({.problem = fmt::format("slump of a Bingham cylinder; yield stress / (rho g H) = {}", GetParam()),
              .quantity = fmt::format("slump / the formula's {:.3f} - 1", expected),
              .resolution = fmt::format("{} particles high", n),
              .error = std::abs(seen / expected - 1.0),
              .bar = 0.1});
}
INSTANTIATE_TEST_SUITE_P(YieldStress, Slump, testing::Values(0.1, 0.2, 0.3));

}  // namespace
}  // namespace smelt
