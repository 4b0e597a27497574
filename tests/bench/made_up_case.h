#pragma once
// A case that takes no time and whose error is known.

#include "bench/cases/case.h"
#include "bench/report/gnuplot.h"
#include "bench/report/suite.h"
#include "core/error.h"

#include <string>
#include <vector>

namespace smelt::test {

/// The error is 2 / resolution^2 with the first method, with the second a failure at resolution 20.
inline Case made_up_case(const std::string& name) {
  return {.name = name,
          .title = "Made-up <case>",
          .measures = "How fast a made-up error falls.",
          .good = "Below 0.01.",
          .good_errors = {0.01},
          .error_label = "made-up error",
          .resolution_label = "particles",
          .profile_x = "x [m]",
          .profile_y = "u [m/s]",
          .methods = {"smooth", "fails \"at\" 20"},
          .quick = {10, 20, 40},
          .full = {10, 20, 40, 80},
          .run = [](std::size_t method, double resolution) {
            if (method == 1 && resolution == 20.0) fail("no, thank you");
            Measurement measured{
                .error = 2.0 / (resolution * resolution), .cpu_seconds = 0.001 * resolution, .n_particles = 7};
            measured.profile = Profile{{{0.0, 1.0}, {0.0, 2.0}}, {{0.0, 1.0}, {0.0, 2.5}}};
            return measured;
          }};
}

/// Whether plots can be drawn here.
inline bool has_gnuplot() {
  try {
    check_gnuplot();
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// What the suite makes of cases, in the order in which they end.
inline std::vector<CaseResult> run_cases(const std::vector<Case>& cases, bool quick = true, unsigned threads = 1) {
  std::vector<CaseResult> results;
  Progress silent;
  run_suite(cases, quick, threads, silent, [&](CaseResult result) { results.push_back(std::move(result)); });
  return results;
}

}  // namespace smelt::test
