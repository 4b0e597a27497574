// Water at rest for ten seconds over a flat floor with its corners, in a tilted box and over a slope: p = rho g (level
// - y).

#include "bench/cases/hydrostatic_pool.h"

#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace smelt {
namespace {

using namespace hydrostatic_pool;

constexpr int n_deep = 24;
constexpr double bar = 0.03;

void test_pool(const Pool& pool) {
  const double duration = full_run() ? 10.0 : 2.5;
  const Seen seen = rest(pool, duration);
  const std::string problem = fmt::format("hydrostatic pool; {}", pool.name);
  const std::string resolution = fmt::format("{} deep; {:g} s", n_deep, duration);
  report_row({problem, "pressure on the wall / rho g H; max after 2 s", resolution, seen.gauge, bar});
  report_row({problem, "pressure of one particle / rho g H; max after 2 s", resolution, seen.particle});
  report_row({problem, "fastest particle at the end [m/s]", resolution, seen.speed});
  report_row({problem, "drift of particles [spacings]; rms", resolution, seen.drift});
}

TEST(HydrostaticPool, FlatFloorAndCorners) {
  test_pool(box_pool("flat floor", 0.0, n_deep));
}
TEST(HydrostaticPool, TiltedBox) {
  test_pool(box_pool("box tilted by 17 degrees", 17.0, n_deep));
}
TEST(HydrostaticPool, Slope) {
  test_pool(slope_pool(n_deep));
}

}  // namespace
}  // namespace smelt
