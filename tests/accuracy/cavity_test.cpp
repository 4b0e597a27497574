// The lid-driven square cavity at Re = 1 [S 4.5.2] against finite differences: four walls, one of which slides.

#include "bench/cases/cavity.h"

#include "bench/cases/set_up.h"
#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

namespace smelt {
namespace {

using namespace cavity;

void report(const Errors& measured, double time, int across, std::optional<double> bar) {
  const std::string problem = fmt::format("lid-driven cavity; Re = 1; after {} L/U", time),
                    resolution = fmt::format("{0} x {0}", across);
  report_row({.problem = problem,
              .quantity = "u on x = 0.5; max / U",
              .resolution = resolution,
              .error = measured.u,
              .bar = bar});
  report_row({.problem = problem,
              .quantity = "v on y = 0.5; max / U",
              .resolution = resolution,
              .error = measured.v,
              .bar = bar});
}

// By 0.3 L/U the flow is steady: its slowest mode decays as exp(-52 t). Later the particles gather in strings near the
// lid's far corner and thin out below its near one, for which there is a row and no bar.
TEST(Cavity, FollowsTheSlidingLid) {
  constexpr int across = 40;
  const Reference reference = read_reference("cavity_re1_centrelines");
  Solver<2, double> solver = make_cavity(across);
  solver.prepare();
  advance_by(solver, 0.3);
  report(measure(solver, reference, across), 0.3, across, 0.02);
  advance_by(solver, 0.2, 0.3);
  report(measure(solver, reference, across), 0.5, across, {});
}

}  // namespace
}  // namespace smelt
