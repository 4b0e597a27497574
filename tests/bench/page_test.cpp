// The page and the CSV behind it. Where gnuplot is not installed the plots are not tested: `./smelt report` installs
// it, `./smelt test` does not.

#include "bench/report/page.h"

#include "bench/report/csv.h"
#include "bench/report/gnuplot.h"
#include "core/error.h"
#include "tests/bench/made_up_case.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace smelt {
namespace {

using test::has_gnuplot;
using test::made_up_case;
using test::run_cases;

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(Page, FitsTheOrder) {
  const CaseResult result = run_cases({made_up_case("one")})[0];
  EXPECT_NEAR(fitted_order(result.runs, 0).value(), 2.0, 1e-12);
  EXPECT_NEAR(fitted_order(result.runs, 1).value(), 2.0, 1e-12);  // by the runs that went well
}

TEST(Page, HasNoOrderOfOneRun) {
  CaseResult result = run_cases({made_up_case("one")})[0];
  result.runs.resize(1);
  EXPECT_FALSE(fitted_order(result.runs, 0));
}

TEST(Page, StatesWhatItIsAndHowFarItIs) {
  const PageHead head{"a machine, 2 cores", "0.1.0", "2026-01-31 12:34 UTC", "./smelt report --quick", true};
  const std::string page = write_page(head, {{"<tr><td>one's row</td></tr>", "<section>one</section>"}}, 2);
  for (const char* text : {"a machine, 2 cores", "0.1.0", "2026-01-31 12:34 UTC", "./smelt report --quick", "one's row",
                           "<section>one</section>", "1 of 2 sections so far"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
  EXPECT_EQ(write_page(head, {{"", "one"}, {"", "two"}}, 2).find("so far"), std::string::npos);
}

TEST(Page, ShowsPlotsFiguresAndFailures) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const std::filesystem::path folder = testing::TempDir();
  const auto [summary, section] = write_case_section(run_cases({made_up_case("one")})[0], true, folder);
  EXPECT_EQ(count(summary, "<td>0.00125</td><td>0.01</td><td>yes</td><td>2.00</td>"), 2u)
      << summary;                         // of both methods, at 40
  EXPECT_EQ(count(section, "<svg"), 3u);  // cost, convergence, profile
  EXPECT_EQ(count(section, "</svg>"), 3u);
  EXPECT_EQ(section.find("<?xml"), std::string::npos);
  EXPECT_NE(section.find("order 2.00"), std::string::npos);
  EXPECT_NE(section.find("Made-up &lt;case&gt;"), std::string::npos);
  EXPECT_NE(section.find("failed: no, thank you"), std::string::npos);
  EXPECT_NE(section.find("./smelt report one --quick"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "one_cost.gnuplot")) << "scripts are taken away";
}

// A case may measure several quantities, each with its own good number.
TEST(Page, JudgesEachMethodByItsOwnGoodNumber) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  Case problem = made_up_case("two");
  problem.good_errors = {0.01, 0.001};
  const auto [summary, section] = write_case_section(run_cases({problem})[0], true, testing::TempDir());
  EXPECT_EQ(count(summary, "<td>0.00125</td><td>0.01</td><td>yes</td>"), 1u) << summary;
  EXPECT_EQ(count(summary, "<td>0.00125</td><td>0.001</td><td>no</td>"), 1u) << summary;
  const auto one = write_case_section(run_cases({made_up_case("one")})[0], true, testing::TempDir()).body;
  const std::string dotted = "stroke-dasharray";
  EXPECT_GT(count(section, dotted), count(one, dotted)) << "a line for each of the numbers";
}

TEST(Gnuplot, LeavesOutWhatALogarithmCannotShow) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const Plot plot{
      "x", "it's y", true, {{"one", {{1.0, 2.0, 3.0}, {0.0, -1.0, std::nan("")}}, Series::Look::line, 0}}, {}};
  EXPECT_EQ(draw_plot(plot, "empty", testing::TempDir()).find("<svg"), std::string::npos);
}

TEST(Csv, HasARowForEveryRun) {
  const std::string csv = write_runs_csv(to_rows(run_cases({made_up_case("one")})[0]));
  EXPECT_EQ(count(csv, "\n"), 7u);
  EXPECT_NE(
      csv.find("case,method,resolution,particles,error,cpu_seconds,failure\n\"one\",\"smooth\",10,7,0.02,0.01,\n"),
      std::string::npos)
      << csv;
  EXPECT_NE(csv.find("\"one\",\"fails \"\"at\"\" 20\",20,,,,\"no, thank you\"\n"), std::string::npos) << csv;
}

TEST(Csv, HasTheProfilesOfTheRunsThatWentWell) {
  const std::string csv = write_profiles_csv(run_cases({made_up_case("one")})[0]);
  EXPECT_EQ(count(csv, "\n"), 1u + 5u * 4u);
  EXPECT_NE(csv.find("\"smooth\",10,reference,1,2.5\n"), std::string::npos) << csv;
}

}  // namespace
}  // namespace smelt
