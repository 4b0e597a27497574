#include "bench/report/expected.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "tests/bench/made_up_case.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace smelt {
namespace {

const ExpectedErrors stored{{"channel", {{"J = 15 at 20", 0.1}, {"J = 15 at 40", 0.01}}},
                            {"slump", {{"clay at 8", 0.2}}}};

std::vector<RunRow> channel_rows(double coarse, double fine) {
  return {{"channel", "J = 15", 20.0, 160, coarse, 0.1, ""}, {"channel", "J = 15", 40.0, 320, fine, 0.4, ""}};
}

TEST(Expected, TakesWhatIsNoMoreThanTenPercentWorse) {
  EXPECT_TRUE(compare_with_expected(stored, channel_rows(0.1, 0.01)).empty());
  EXPECT_TRUE(compare_with_expected(stored, channel_rows(0.1099, 0.0)).empty());
}

TEST(Expected, RefusesWhatIsWorse) {
  const auto complaints = compare_with_expected(stored, channel_rows(0.1101, 0.01));
  ASSERT_EQ(complaints.size(), 1u);
  EXPECT_NE(complaints[0].find("channel, J = 15 at 20: the error is 0.1101, stored is 0.1"), std::string::npos)
      << complaints[0];
}

TEST(Expected, RefusesWhatIsNotANumber) {
  EXPECT_EQ(compare_with_expected(stored, channel_rows(std::numeric_limits<double>::quiet_NaN(), 0.01)).size(), 1u);
}

TEST(Expected, RefusesAFailedRun) {
  auto rows = channel_rows(0.1, 0.0);
  rows[1].failure = "NaN in particle 3";
  const auto complaints = compare_with_expected(stored, rows);
  ASSERT_EQ(complaints.size(), 1u);
  EXPECT_NE(complaints[0].find("NaN in particle 3"), std::string::npos);
}

TEST(Expected, RefusesARunWithoutStoredErrorAndAStoredErrorWithoutRun) {
  auto rows = channel_rows(0.1, 0.01);
  rows[1].resolution = 60.0;
  EXPECT_EQ(compare_with_expected(stored, rows).size(), 2u);
  EXPECT_EQ(compare_with_expected({}, rows).size(), 2u);
}

TEST(Expected, ComesBackFromItsFile) {
  const auto path = std::filesystem::path(testing::TempDir()) / "expected.toml";
  write_expected(path, stored, channel_rows(0.05, 0.005));
  const ExpectedErrors read = read_expected(path);
  EXPECT_EQ(read.at("slump"), stored.at("slump"));  // a case that did not run is kept
  EXPECT_DOUBLE_EQ(read.at("channel").at("J = 15 at 20"), 0.05);
  EXPECT_TRUE(compare_with_expected(read, channel_rows(0.05, 0.005)).empty());
}

TEST(Expected, IsNotStoredFromFailures) {
  const auto path = std::filesystem::path(testing::TempDir()) / "failed.toml";
  auto rows = channel_rows(0.1, 0.01);
  rows[0].failure = "diverged";
  EXPECT_THROW(write_expected(path, stored, rows), Error);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(Expected, NamesTheLineOfWhatIsNoError) {
  const auto path = std::filesystem::path(testing::TempDir()) / "wrong.toml";
  write_file_atomically(path, "[channel]\n\"J = 15 at 20\" = \"small\"\n");
  try {
    read_expected(path);
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("wrong.toml:2"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace smelt
