#include "bench/report/report.h"

#include "bench/report/csv.h"
#include "bench/report/expected.h"
#include "bench/report/gnuplot.h"
#include "bench/report/page.h"
#include "bench/report/suite.h"
#include "core/error.h"
#include "io/atomic_file.h"
#include "scenes/nearest_word.h"
#include "scenes/version.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>

namespace smelt {

namespace {

/// What is on the disk: every case that is done, in the order of the suite.
class ReportFolder {
 public:
  ReportFolder(const std::vector<Case>& cases, const ReportOptions& options)
      : cases_(cases), options_(options), head_{describe_machine(), std::string(version), describe_now(), options.command, options.quick} {
    create_directories_or_fail(options.folder);
  }

  void add(const CaseResult& result) {
    const std::string& name = result.problem.name;
    sections_[name] = write_case_section(result, options_.quick, options_.folder);
    rows_[name] = to_rows(result);
    const std::string profiles = write_profiles_csv(result);
    if (!profiles.empty()) write_file_atomically(options_.folder / fmt::format("profile_{}.csv", name), profiles);
    write_file_atomically(options_.folder / "runs.csv", write_runs_csv(rows()));
    std::vector<std::string> sections;
    for (const Case& problem : cases_)
      if (sections_.contains(problem.name)) sections.push_back(sections_.at(problem.name));
    write_file_atomically(options_.folder / "index.html", write_page(head_, sections, cases_.size()));
  }

  std::vector<RunRow> rows() const {
    std::vector<RunRow> all;
    for (const Case& problem : cases_)
      if (const auto found = rows_.find(problem.name); found != rows_.end()) all.insert(all.end(), found->second.begin(), found->second.end());
    return all;
  }

 private:
  const std::vector<Case>& cases_;
  const ReportOptions& options_;
  PageHead head_;
  std::map<std::string, std::string> sections_;
  std::map<std::string, std::vector<RunRow>> rows_;
};

/// Complaints as one Error.
void fail_with(const std::vector<std::string>& complaints, const std::string& what_to_do) {
  if (!complaints.empty()) fail("{}\n{}", fmt::join(complaints, "\n"), what_to_do);
}

std::vector<std::string> failures(const std::vector<RunRow>& rows) {
  std::vector<std::string> out;
  for (const RunRow& row : rows)
    if (!row.failure.empty()) out.push_back(fmt::format("{}, {} at {:g} failed: {}", row.problem, row.method, row.resolution, row.failure));
  return out;
}

}  // namespace

std::vector<Case> choose_cases(const std::vector<Case>& all, const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const Case& problem : all) known.push_back(problem.name);
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const auto nearest = nearest_word(name, known);
    fail("there is no case \"{}\"{}; cases are {}", name, nearest ? fmt::format(" (did you mean \"{}\"?)", *nearest) : "", fmt::join(known, ", "));
  }
  std::vector<Case> chosen;
  for (const Case& problem : all)
    if (names.empty() || std::find(names.begin(), names.end(), problem.name) != names.end()) chosen.push_back(problem);
  return chosen;
}

void make_report(const std::vector<Case>& cases, const ReportOptions& options, Progress& progress) {
  check_gnuplot();
  ExpectedErrors expected;
  if (options.check || (options.write_expected && std::filesystem::exists(options.expected))) expected = read_expected(options.expected);
  ReportFolder folder(cases, options);
  run_suite(cases, options.quick, options.threads, progress, [&](const CaseResult& result) { folder.add(result); });

  const std::vector<RunRow> rows = folder.rows();
  if (options.write_expected) return write_expected(options.expected, std::move(expected), rows);
  if (options.check)
    fail_with(compare_with_expected(expected, rows),
              fmt::format("worse than {}; where the change is meant, `./smelt report --quick --write-expected` stores the errors anew", options.expected.string()));
  fail_with(failures(rows), fmt::format("the rest is in {}", (options.folder / "index.html").string()));
}

}  // namespace smelt
