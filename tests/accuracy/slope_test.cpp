// A viscoplastic layer on a slope: below the critical thickness it rests, above it flows, and the thickness is right.

#include "bench/cases/slope.h"

#include "tests/accuracy/measure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace smelt {
namespace {

using namespace slope;

constexpr int n_rows = 40;
constexpr const char* resolution = "40 rows";

TEST(Slope, RestsBelowTheCriticalThickness) {
  report_row({.problem = "viscoplastic layer on a slope; 0.95 of the critical thickness",
              .quantity = "speed of the surface / creep at J = 100000 - 1",
              .resolution = resolution,
              .error = std::abs(run_layer(n_rows, 0.95, 3.0) / exact_speed(0.95) - 1.0),
              .bar = 0.5});
  // Rows of stress that alternate, to which corrected gradients are blind, bring the bed to yield.
  report_row({.problem = "viscoplastic layer on a slope; 0.95 of the critical thickness",
              .quantity = "the same with h = 1.3 spacings for 1.2",
              .resolution = resolution,
              .error = std::abs(run_layer(n_rows, 0.95, 3.0, 1.3) / exact_speed(0.95) - 1.0)});
}

TEST(Slope, FlowsAboveIt) {
  report_row({.problem = "viscoplastic layer on a slope; 1.05 of the critical thickness",
              .quantity = "speed of the surface / exact - 1",
              .resolution = resolution,
              .error = std::abs(run_layer(n_rows, 1.05, 3.0) / exact_speed(1.05) - 1.0),
              .bar = 0.1});
  report_row({.problem = "viscoplastic layer on a slope; 1.5 of the critical thickness",
              .quantity = "speed of the surface / exact - 1",
              .resolution = resolution,
              .error = std::abs(run_layer(n_rows, 1.5, 5.0) / exact_speed(1.5) - 1.0),
              .bar = 0.02});
}

// A layer flows where its surface is three times as fast as creep is at the critical thickness; the exact speed passes
// that 0.7 % above.
TEST(Slope, HasTheCriticalThickness) {
  const double limit = 3.0 * exact_speed(1.0);
  double rests = 0.9, flows = 1.1;
  ASSERT_LT(run_layer(n_rows, rests, 2.0), limit);
  ASSERT_GT(run_layer(n_rows, flows, 2.0), limit);
  while (flows - rests > 0.015) {
    const double middle = 0.5 * (rests + flows);
    (run_layer(n_rows, middle, 2.0) < limit ? rests : flows) = middle;
  }
  report_row({.problem = "viscoplastic layer on a slope",
              .quantity = "critical thickness / exact - 1 (bisected)",
              .resolution = resolution,
              .error = std::max(std::abs(rests - 1.0), std::abs(flows - 1.0)),
              .bar = 0.05});
}

}  // namespace
}  // namespace smelt
