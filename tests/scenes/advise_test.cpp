#include "scenes/advise.h"

#include "scenes/check_scene.h"
#include "scenes/scene_reader.h"
#include "tests/source_folder.h"

#include <gtest/gtest.h>

#include <numeric>

namespace smelt {
namespace {

/// What `check` says of the bunny's scene with these settings, in one text.
std::string advice_on(std::vector<std::string> overrides) {
  overrides.push_back("particles.count=1000");
  const Scene scene = read_scene(source_folder() / "scenes/melting_bunny.toml", overrides);
  const std::vector<std::string> advice = forecast_scene(scene, 1, false).advice;
  return std::accumulate(advice.begin(), advice.end(), std::string(), [](const std::string& a, const std::string& b) { return a + b + "\n"; });
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

}  // namespace
}  // namespace smelt
