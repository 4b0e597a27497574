#include "scenes/run_report.h"

#include "io/atomic_file.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <unistd.h>

namespace smelt {
namespace {

std::filesystem::path report_file(const std::string& name) {
  const auto folder = std::filesystem::path(testing::TempDir()) / ("run_report_" + std::to_string(::getpid())) / name;
  std::filesystem::create_directories(folder);
  return folder / "run.json";
}

TEST(RunReport, SaysWhatFilesWereMadeFrom) {
  const auto path = report_file("settings");
  RunReport report(path, false);
  EXPECT_FALSE(report.settings_of(2, "surface"));
  report.set_surfaced(2, 1.0, 8, 12, {}, 0xfedcba9876543210);
  report.set_rendered(2, 0.0, {}, 17);
  RunReport again(path, true);
  EXPECT_EQ(again.settings_of(2, "surface"), 0xfedcba9876543210);
  EXPECT_EQ(again.settings_of(2, "render"), 17u);
  EXPECT_FALSE(again.settings_of(1, "surface"));

  // Cut off while the surface is made anew: neither the old settings nor the new ones.
  again.begin(2, "surface");
  EXPECT_FALSE(RunReport(path, true).settings_of(2, "surface"));
  EXPECT_EQ(RunReport(path, true).settings_of(2, "render"), 17u);
}

// Two machines draw their share of the frames in one folder.
TEST(RunReport, KeepsWhatOthersWroteMeanwhile) {
  const auto path = report_file("shared");
  RunReport(path, false).set_surfaced(1, 1.0, 8, 12, {}, 5);
  RunReport first(path, true), second(path, true);
  first.set_rendered(1, 0.0, {}, 11);
  second.set_rendered(2, 0.0, {}, 12);
  first.set_rendered(3, 0.0, {}, 13);
  second.begin(2, "render");
  const RunReport seen(path, true);
  EXPECT_EQ(seen.settings_of(1, "surface"), 5u);
  EXPECT_EQ(seen.settings_of(1, "render"), 11u);
  EXPECT_FALSE(seen.settings_of(2, "render"));
  EXPECT_EQ(seen.settings_of(3, "render"), 13u);
  EXPECT_EQ(nlohmann::json::parse(read_file(path))["frames"].size(), 3u);
  for (const auto& entry : std::filesystem::directory_iterator(path.parent_path()))
    EXPECT_EQ(entry.path().filename(), "run.json") << "nothing else is left behind";
}

}  // namespace
}  // namespace smelt
