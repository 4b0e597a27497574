// The collapse of a water column: its front against three sets of experiments, and its late speed, which hardly depends
// on the fitted origin of time. Bar: the spread between the experiments as published where all three overlap, and 3 %.

#include "bench/cases/dam_break.h"

#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace smelt {
namespace {

using namespace dam_break;

/// Largest difference between any two experiments at one T, over their mean.
double spread(const std::vector<Reference>& sets) {
  double largest = 0.0;
  for (double t = 0.85; t < 3.09; t += 0.01) {
    double low = std::numeric_limits<double>::infinity(), high = 0.0;
    for (const Reference& e : sets) low = std::min(low, e.at(t)), high = std::max(high, e.at(t));
    largest = std::max(largest, 2.0 * (high - low) / (high + low));
  }
  return largest;
}

TEST(DamBreak, FrontFollowsTheExperiments) {
  const int n = full_run() ? 60 : 20;
  const Reference run = collapse(n).front;
  std::vector<Reference> sets;
  for (const char* name : experiments) sets.push_back(read_reference(fmt::format("dam_break_{}", name)));
  const double bar = spread(sets) + 0.03;
  const std::string resolution = fmt::format("{} across a", n);
  for (std::size_t k = 0; k < sets.size(); ++k) {
    const std::string problem = fmt::format("dam break; {}", experiments[k]);
    const double origin = fit_origin(run, sets[k]);
    report_row({problem, "front position relative; max; origin of time fitted", resolution,
                compare(run, sets[k], origin).max, bar});
    report_row({problem, "that origin [sqrt(a/2g)]", resolution, origin});
    report_row({problem, "front position relative; max; both from T = 0", resolution, compare(run, sets[k], 0.0).max});
    const double from = 2.3, to = 2.95;
    const double ours = front_at(run, to - origin) - front_at(run, from - origin);
    report_row({problem, "front speed relative; T 2.3 to 2.95", resolution,
                std::abs(ours / (sets[k].at(to) - sets[k].at(from)) - 1.0)});
  }
}

}  // namespace
}  // namespace smelt
