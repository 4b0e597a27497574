// Water discharge [S 4.5.3.2] against Torricelli.

#include "bench/cases/water_discharge.h"

#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace smelt {
namespace {

void test_discharge(int n_across) {
  const water_discharge::Jet jet = water_discharge::discharge(n_across);
  const std::string resolution = fmt::format("{} particles", jet.particles.size());
  report_row({"water discharge", "speed of the jet over Torricelli's less 1; mean 0.2 to 0.3 s", resolution,
              std::abs(jet.speed / jet.torricelli - 1.0), 0.05});
  report_row(
      {"water discharge", "fastest particle of the jet over Torricelli's less 1", resolution, jet.fastest - 1.0, 0.3});
  report_row({"water discharge", "particles found behind walls", resolution, static_cast<double>(jet.leaked), 0.0});
}

TEST(WaterDischarge, JetLeavesAtTorricellisSpeed) {
  test_discharge(24);
  test_discharge(36);
  if (full_run()) test_discharge(48);
}

}  // namespace
}  // namespace smelt
