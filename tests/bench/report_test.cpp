#include "bench/report/report.h"

#include "bench/cases/all_cases.h"
#include "bench/cases/extremes.h"
#include "bench/report/stability.h"
#include "core/error.h"
#include "io/atomic_file.h"
#include "tests/bench/made_up_case.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

namespace smelt {
namespace {

using test::has_gnuplot;
using test::made_up_case;

TEST(Report, EveryCaseSaysWhatItIs) {
  std::set<std::string> names;
  for (const Case& problem : all_cases()) {
    SCOPED_TRACE(problem.name);
    EXPECT_TRUE(names.insert(problem.name).second);
    EXPECT_TRUE(problem.measures.ends_with(".") && problem.good.ends_with("."));
    EXPECT_GE(problem.quick.size(), 3u);
    EXPECT_LE(problem.full.size(), 6u);
    EXPECT_TRUE(std::is_sorted(problem.quick.begin(), problem.quick.end()) &&
                std::is_sorted(problem.full.begin(), problem.full.end()));
    EXPECT_FALSE(problem.methods.empty());
    EXPECT_TRUE(problem.good_errors.size() == 1 || problem.good_errors.size() == problem.methods.size());
    for (const double good : problem.good_errors) EXPECT_GT(good, 0.0);
  }
  EXPECT_GE(names.size(), 12u);
}

TEST(Report, ChoosesCasesByName) {
  const std::vector<Case> all{made_up_case("channel"), made_up_case("slump"), made_up_case("cavity")};
  EXPECT_EQ(select(all, {}).cases.size(), 3u);
  EXPECT_TRUE(select(all, {}).stability);
  const Selection chosen = select(all, {"cavity", "channel"});
  ASSERT_EQ(chosen.cases.size(), 2u);
  EXPECT_EQ(chosen.cases[0].name, "channel");
  EXPECT_FALSE(chosen.stability);
  EXPECT_TRUE(select(all, {"stability"}).stability);
  EXPECT_TRUE(select(all, {"stability"}).cases.empty());
}

TEST(Report, NamesTheCasesWhereThereIsNoSuchOne) {
  try {
    select({made_up_case("channel"), made_up_case("slump")}, {"chanel"});
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "there is no case \"chanel\" (did you mean \"channel\"?); cases are channel, slump, stability");
  }
}

/// With gnuplot: writes a report of two cases into a folder of its own, the second of which fails in part.
TEST(Report, LosesNothingToAFailure) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const auto folder = std::filesystem::path(testing::TempDir()) / "report_test";
  std::filesystem::remove_all(folder);
  ReportOptions options;
  options.quick = true;
  options.folder = folder;
  Progress silent;
  try {
    make_report({{made_up_case("first"), made_up_case("second")}, false}, options, silent);
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("second, fails \"at\" 20 at 20 failed: no, thank you"), std::string::npos) << message;
  }
  const std::string page = read_file(folder / "index.html");
  EXPECT_NE(page.find("<section id=\"first\">"), std::string::npos);
  EXPECT_NE(page.find("<section id=\"second\">"), std::string::npos);
  for (const char* file : {"runs.csv", "profile_first.csv", "profile_second.csv"})
    EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
}

/// With gnuplot: a stored error that is met, and one that is not.
TEST(Report, ChecksAgainstStoredErrors) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  ReportOptions options;
  options.quick = true;
  options.folder = std::filesystem::path(testing::TempDir()) / "check_test";
  options.expected = std::filesystem::path(testing::TempDir()) / "check_test.toml";
  Case problem = made_up_case("first");
  problem.methods.resize(1);
  Progress silent;
  options.write_expected = true;
  make_report({{problem}, false}, options, silent);
  options.write_expected = false;
  options.check = true;
  EXPECT_NO_THROW(make_report({{problem}, false}, options, silent));
  problem.run = [](std::size_t, double resolution) { return Measurement{.error = 2.3 / (resolution * resolution)}; };
  EXPECT_THROW(make_report({{problem}, false}, options, silent), Error);
}

// `--check` minds the hard cases too: those that gave up or gained energy at the usual time step.
TEST(Report, NamesTheHardCasesThatDidNotHold) {
  using extremes::default_courant;
  Watched sound, gained;
  gained.energy_gain = 2.0 * extremes::energy_bar;
  Stability stability;
  stability.cases = {{"held", {{0.1, sound, "gave up elsewhere"}, {default_courant, sound, ""}}},
                     {"gave up", {{default_courant, sound, "NaN at step 3"}}},
                     {"gained", {{default_courant, gained, ""}}}};
  const std::vector<std::string> complaints = failures(stability);
  ASSERT_EQ(complaints.size(), 2u);
  EXPECT_NE(complaints[0].find("stability, gave up"), std::string::npos) << complaints[0];
  EXPECT_NE(complaints[0].find("NaN at step 3"), std::string::npos) << complaints[0];
  EXPECT_NE(complaints[1].find("stability, gained"), std::string::npos) << complaints[1];
}

}  // namespace
}  // namespace smelt
