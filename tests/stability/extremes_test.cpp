// Scenes at the edge of what the method can be asked: each must end, finite and with no energy from nowhere.

#include "bench/cases/extremes.h"

#include "tests/stability/watch.h"

#include <algorithm>

namespace smelt {
namespace {

using namespace extremes;

void report_hard(const std::string& name) {
  HardScene scene = make_hard_scene(name);
  const Watched seen = watch(scene.solver, scene.duration);
  report_watched(name, seen, scene.solver.particles().size(), energy_bar);
}

TEST(Extremes, TwoParticlesOnOnePlace) {
  report_hard("two particles 1e-9 m apart that meet at 1 m/s");
  report_hard("two particles 1e-9 m apart within a block");
}

TEST(Extremes, ViscosityJumpsAMillionfold) {
  report_hard("viscosity jumps 10^6-fold; relaxed stress");
  report_hard("viscosity jumps 10^6-fold; stress at once");
}

TEST(Extremes, JumpNumberFromOneTo1e5) {
  Watched worst;
  std::size_t n = 0;
  for (const double jump : jumps()) {
    SCOPED_TRACE(jump);
    HardScene scene = make_hard_scene(name_of_block(jump));
    const Watched seen = watch(scene.solver, scene.duration);
    EXPECT_LE(seen.energy_gain, energy_bar);
    worst = {std::max(worst.energy_gain, seen.energy_gain), std::max(worst.density_error, seen.density_error),
             std::max(worst.steps, seen.steps)};
    n = scene.solver.particles().size();
  }
  report_watched("blocks with J from 1 to 10^5; the worst", worst, n, energy_bar);
}

TEST(Extremes, ThreadOneParticleThick) {
  report_hard("thread one particle thick");
}

TEST(Extremes, DropsOfOneTwoAndFive) {
  for (const int n : {1, 2, 5}) report_hard(fmt::format("drop of {}", n));
}

TEST(Extremes, HotBesideCold) {
  HardScene scene = make_hard_scene("1 K beside 5000 K");
  const Watched seen = watch(scene.solver, scene.duration);
  const auto& p = scene.solver.particles();
  report_watched("1 K beside 5000 K", seen, p.size(), energy_bar);
  const auto [coldest, hottest] = std::minmax_element(p.temperature.begin(), p.temperature.end());
  EXPECT_GT(*coldest, 10.0) << "heat did not flow";
  report_row({.problem = "1 K beside 5000 K",
              .quantity = "temperature beyond its bounds [K]",
              .resolution = fmt::format("{} particles {} steps", p.size(), seen.steps),
              .error = std::max({0.0, 1.0 - *coldest, *hottest - 5000.0}),
              .bar = 0.0});
}

}  // namespace
}  // namespace smelt
