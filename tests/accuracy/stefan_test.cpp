// A melting front: a solid at its melting point on a hot wall, one phase, against Neumann's similarity solution.

#include "bench/cases/stefan.h"

#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <vector>

namespace smelt {
namespace {

using namespace stefan;

TEST(Stefan, FrontOfAMeltingSolid) {
  const double finest = full_run() ? 1.0 / 80.0 : 1.0 / 40.0;
  for (const double stefan_number : {0.1, 0.5, 2.0}) {
    const double farthest = farthest_front(stefan_number);
    std::vector<double> spacing, error;
    for (const double coarser : {4.0, 2.0, 1.0}) {
      spacing.push_back(coarser * finest);
      error.push_back(measure_front(spacing.back(), stefan_number, 0.0, farthest).error);
    }
    report_row(
        {.problem = fmt::format("Stefan front; Ste = {}", stefan_number),
         .quantity = "front / exact - 1; max over times",
         .resolution = fmt::format("{:.0f} to {:.0f} in the column", 1.0 / spacing.front(), 1.0 / spacing.back()),
         .error = error.back(),
         .bar = 0.02,
         .order = convergence_order(spacing, error)});
    report_row({.problem = fmt::format("Stefan front; Ste = {}", stefan_number),
                .quantity = "front / exact - 1; max over times (jitter 0.1)",
                .resolution = fmt::format("{:.0f} in the column", 1.0 / finest),
                .error = measure_front(finest, stefan_number, 0.1, farthest).error,
                .bar = 0.02});
  }
}

}  // namespace
}  // namespace smelt
