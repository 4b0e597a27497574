#include "bench/report/report.h"

#include "bench/report/csv.h"
#include "bench/report/expected.h"
#include "bench/report/gnuplot.h"
#include "bench/report/page.h"
#include "bench/report/stability.h"
#include "bench/report/suite.h"
#include "core/error.h"
#include "io/atomic_file.h"
#include "scenes/nearest_word.h"
#include "scenes/version.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

namespace smelt {

namespace {

constexpr const char* stability_name = "stability";

/// What is on the disk: every section that is done, in the order of the selection.
class ReportFolder {
 public:
  ReportFolder(const Selection& selection, const ReportOptions& options)
      : options_(options),
        head_{describe_machine(), std::string(version), describe_now(), options.command, options.quick} {
    for (const Case& problem : selection.cases) order_.push_back(problem.name);
    if (selection.stability) order_.emplace_back(stability_name);
    create_directories_or_fail(options.folder);
  }

  void add(const CaseResult& result) {
    const std::string& name = result.problem.name;
    rows_[name] = to_rows(result);
    const std::string profiles = write_profiles_csv(result);
    if (!profiles.empty()) write_file_atomically(options_.folder / fmt::format("profile_{}.csv", name), profiles);
    write_file_atomically(options_.folder / "runs.csv", write_runs_csv(rows()));
    add_section(name, write_case_section(result, options_.quick, options_.folder));
  }

  void add(const Stability& stability) {
    write_file_atomically(options_.folder / "stability.csv", write_stability_csv(stability));
    add_section(stability_name, write_stability_section(stability, options_.quick, options_.folder));
  }

  std::vector<RunRow> rows() const {
    std::vector<RunRow> all;
    for (const std::string& name : order_)
      if (const auto found = rows_.find(name); found != rows_.end())
        all.insert(all.end(), found->second.begin(), found->second.end());
    return all;
  }

 private:
  void add_section(const std::string& name, Section section) {
    sections_[name] = std::move(section);
    std::vector<Section> sections;
    for (const std::string& done : order_)
      if (sections_.contains(done)) sections.push_back(sections_.at(done));
    write_file_atomically(options_.folder / "index.html", write_page(head_, sections, order_.size()));
  }

  const ReportOptions& options_;
  PageHead head_;
  std::vector<std::string> order_;
  std::map<std::string, Section> sections_;
  std::map<std::string, std::vector<RunRow>> rows_;
};

/// Complaints as one Error.
void fail_with(const std::vector<std::string>& complaints, const std::string& what_to_do) {
  if (!complaints.empty()) fail("{}\n{}", fmt::join(complaints, "\n"), what_to_do);
}

std::vector<std::string> failures(const std::vector<RunRow>& rows) {
  std::vector<std::string> out;
  for (const RunRow& row : rows)
    if (!row.failure.empty())
      out.push_back(fmt::format("{}, {} at {:g} failed: {}", row.problem, row.method, row.resolution, row.failure));
  return out;
}

}  // namespace

Selection select(const std::vector<Case>& all, const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const Case& problem : all) known.push_back(problem.name);
  known.emplace_back(stability_name);
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const auto nearest = nearest_word(name, known);
    fail("there is no case \"{}\"{}; cases are {}", name,
         nearest ? fmt::format(" (did you mean \"{}\"?)", *nearest) : "", fmt::join(known, ", "));
  }
  const auto wanted = [&](const std::string& name) {
    return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
  };
  Selection selection{{}, wanted(stability_name)};
  std::copy_if(all.begin(), all.end(), std::back_inserter(selection.cases),
               [&](const Case& problem) { return wanted(problem.name); });
  return selection;
}

void make_report(const Selection& selection, const ReportOptions& options, Progress& progress) {
  check_gnuplot();
  ExpectedErrors expected;
  if (options.check || (options.write_expected && std::filesystem::exists(options.expected)))
    expected = read_expected(options.expected);
  ReportFolder folder(selection, options);
  run_suite(selection.cases, options.quick, options.threads, progress,
            [&](const CaseResult& result) { folder.add(result); });
  std::vector<std::string> complaints;
  if (selection.stability) {
    const Stability stability = probe_stability(options.quick, options.threads, progress);
    folder.add(stability);
    if (options.check) complaints = failures(stability);
  }

  const std::vector<RunRow> rows = folder.rows();
  if (options.write_expected) return write_expected(options.expected, std::move(expected), rows);
  if (options.check)
    fail_with(
        compare_with_expected(expected, rows),
        fmt::format(
            "worse than {}; where the change is meant, `./smelt report --quick --write-expected` stores the errors "
            "anew",
            options.expected.string()));
  const std::vector<std::string> failed = failures(rows);
  complaints.insert(complaints.end(), failed.begin(), failed.end());
  fail_with(complaints, fmt::format("the rest is in {}", (options.folder / "index.html").string()));
}

}  // namespace smelt
