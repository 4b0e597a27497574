// Steady plane channel flow of a viscoplastic fluid [P 6-1] between two walls, with the relaxed stress: profile and
// plug.

#include "bench/cases/smd_channel.h"

#include "bench/cases/set_up.h"
#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace smelt {
namespace {

using namespace smd_channel;

/// From rest: steady after 4 s. By 8 s the rows at the walls have slid eight spacings past each other; what that
/// disorder costs has a row and no bar.
void report_channel(int jump) {
  constexpr int across = 40;
  const Reference reference = read_profile(jump);
  Solver<2, double> solver = make_channel(across, jump);
  solver.prepare();
  advance_by(solver, steady_time);
  const Errors steady = measure(solver.particles(), reference, across);
  advance_by(solver, steady_time, steady_time);
  const Errors later = measure(solver.particles(), reference, across);
  const std::string problem = fmt::format("viscoplastic channel; J = {}", jump),
                    resolution = fmt::format("{} across", across);
  report_row({.problem = problem,
              .quantity = "velocity L2 / L2 of the velocity",
              .resolution = resolution,
              .error = steady.velocity,
              .bar = 0.02});
  report_row({.problem = problem,
              .quantity = "the same after twice the time",
              .resolution = resolution,
              .error = later.velocity});
  report_row({.problem = problem,
              .quantity = "half width of the plug - exact / spacing",
              .resolution = resolution,
              .error = std::abs(steady.plug - 0.5) * across / 2.0,
              .bar = 1.0});
}

TEST(SmdChannel, J15) {
  report_channel(15);
}
TEST(SmdChannel, J150) {
  report_channel(150);
}
TEST(SmdChannel, J1500) {
  report_channel(1500);
}

}  // namespace
}  // namespace smelt
