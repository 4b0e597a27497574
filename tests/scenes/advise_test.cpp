#include "scenes/advise.h"

#include "io/atomic_file.h"
#include "scenes/check_scene.h"
#include "scenes/expected_speed.h"
#include "scenes/machine_pace.h"
#include "scenes/scene_reader.h"
#include "tests/source_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <numeric>
#include <unistd.h>

namespace smelt {
namespace {

/// What `check` says of the bunny's scene with these settings, in one text.
std::string advice_on(std::vector<std::string> overrides) {
  overrides.emplace_back("particles.count=1000");
  const Scene scene = read_scene(source_folder() / "scenes/melting_bunny.toml", overrides);
  const std::vector<std::string> advice = forecast_scene(scene, 1, false).advice;
  return std::accumulate(advice.begin(), advice.end(), std::string(),
                         [](const std::string& a, const std::string& b) { return a + b + "\n"; });
}

void expect_says(const std::string& advice, const std::string& text) {
  EXPECT_NE(advice.find(text), std::string::npos) << "\"" << advice << "\" does not say \"" << text << "\"";
}

TEST(Advise, TheBunnyIsWellChosen) {
  EXPECT_EQ(advice_on({}), "");
}

TEST(Advise, ASoundSpeedTooLowOrTooHigh) {
  expect_says(advice_on({"solver.sound_speed_m_s=8"}), "sound_speed_m_s = 8 is only");
  expect_says(advice_on({"solver.sound_speed_m_s=8"}), "choose 4");  // ten times 4.0 m/s
  expect_says(advice_on({"solver.sound_speed_m_s=500"}), "times as long");
}

/// Of a scene in scenes/, by name.
ExpectedSpeed expected_of(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return expect_speed(build_simulation(read_scene(source_folder() / "scenes" / name, overrides)));
}

// What melts and falls may go as fast as a fall through the scene; lava that creeps down a mountain will not.
TEST(Advise, LavaIsMeasuredByHowItCreeps) {
  const ExpectedSpeed bunny =
      expected_of("melting_bunny.toml", {"particles.count=1000", "body.0.translate_m=[0.0, 2.0, 0.0]"});
  expect_says(bunny.reason, "through the whole scene");
  for (const std::string name : {"lava_volcano.toml", "lava_sugarloaf.toml"}) {
    const SimulationSetup setup = build_simulation(read_scene(source_folder() / "scenes" / name, {}));
    const ExpectedSpeed lava = expect_speed(setup);
    expect_says(lava.reason, "in a layer");
    EXPECT_LT(lava.speed, 20.0) << name << ": some metres a second";
    EXPECT_GT(lava.speed, 5.0) << name;
    EXPECT_GT(setup.expected_speed, 40.0) << name << ": of a fall down the mountain";
  }
}

// What a vent 24 m wide pours of a Newtonian fluid, 1200 m^3/s, in a layer as wide down a slope: q = w d^3/(3 mu),
// u = w d^2/(2 mu), with w = rho g sin(slope); on ground that is nearly flat, off its own pile of slope d/24 m.
TEST(Advise, ANewtonianLayerRunsAtItsExactSpeed) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "smelt_advise_slope";
  std::filesystem::create_directories(folder);
  for (const double degrees : {3.0, 15.0, 30.0}) {
    const double slope = degrees * std::numbers::pi / 180.0, rise = std::tan(slope);
    const std::filesystem::path ground = folder / "ground.obj";
    std::ofstream(ground) << fmt::format("v -500 {0} -400\nv -500 {0} 400\nv 100 {1} 400\nv 100 {1} -400\nf 1 2 3 4\n",
                                         190.0 - 260.0 * rise, 190.0 + 340.0 * rise);
    const ExpectedSpeed found =
        expected_of("lava_volcano.toml",
                    {"material.0.viscosity={ law = \"newtonian\", viscosity_Pa_s = 2e3 }",
                     fmt::format("collider.0.mesh=\"{}\"", ground.string()), "emitter.0.position_m=[-240, 200, 40]",
                     "emitter.1.position_m=[-240, 200, 80]", "emitter.2.position_m=[-240, 200, 120]"});
    const double q = 1200.0 / 24.0, weight = 2600.0 * 9.81;
    const bool piles = degrees < 5.0;
    const double d =
        piles ? std::pow(3.0 * 2e3 * q * 24.0 / weight, 0.25) : std::cbrt(3.0 * 2e3 * q / (weight * std::sin(slope)));
    const double u = weight * (piles ? d / 24.0 : std::sin(slope)) * d * d / 4e3;
    EXPECT_NEAR(found.speed / u, 1.0, 1e-2) << degrees << " degrees: " << found.reason;
  }
  std::filesystem::remove_all(folder);
}

TEST(Advise, ARelaxedStressTooSoft) {
  expect_says(advice_on({"solver.shear_wave_speed_m_s=2"}), "would sag by");
}

TEST(Advise, AViscosityThatRulesTheStep) {
  expect_says(advice_on({"solver.shear_wave_speed_m_s=0"}), "material \"wax\": its viscosity at rest");
  expect_says(advice_on({"solver.shear_wave_speed_m_s=0"}), "shear_wave_speed_m_s = 30");
}

TEST(Advise, AFloorOfTheTimeStepThatStopsTheShot) {
  const std::string advice = advice_on({"time_step.min_s=0.01"});
  expect_says(advice, "[time_step] min_s = 0.01 is above the first step");
  // Following it clears it.
  const std::string choose = advice.substr(advice.rfind("choose ") + 7);
  EXPECT_EQ(advice_on({"time_step.min_s=" + choose.substr(0, choose.find('\n'))}), "");
}

// A home folder may be shared: what another machine was calibrated to says nothing of this one.
TEST(MachinePace, IsThatOfThisMachineAlone) {
  const auto folder = std::filesystem::path(testing::TempDir()) / ("pace_" + std::to_string(::getpid()));
  std::filesystem::remove_all(folder);
  ::setenv("XDG_CACHE_HOME", folder.c_str(), 1);
  EXPECT_FALSE(measure_load());
  EXPECT_GT(calibrate_pace(), 0.0);
  EXPECT_GE(measure_load().value_or(0.0), 1.0);
  const nlohmann::json here = nlohmann::json::parse(read_file(pace_file()));
  for (const char* key : {"cpu", "threads", "smelt"}) {
    nlohmann::json other = here;
    other[key] = "another";
    write_file_atomically(pace_file(), other.dump());
    EXPECT_FALSE(measure_load()) << key;
    other.erase(key);  // as an earlier smelt wrote it
    write_file_atomically(pace_file(), other.dump());
    EXPECT_FALSE(measure_load()) << key;
  }
  ::unsetenv("XDG_CACHE_HOME");
}

}  // namespace
}  // namespace smelt
