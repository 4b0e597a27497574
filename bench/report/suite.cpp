#include "bench/report/suite.h"

#include "bench/report/jobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <utility>

namespace smelt {

namespace {

struct Place {
  std::size_t problem, run;
};

void perform(const Case& problem, Run& run) {
  try {
    run.measured = problem.run(run.method, run.resolution);
  } catch (const std::exception& error) {
    run.failure = error.what();
  }
}

std::string describe(const Case& problem, const Run& run) {
  const std::string which = fmt::format("{}, {} at {:g}", problem.name, problem.methods[run.method], run.resolution);
  if (run.failed()) return fmt::format("{} failed: {}", which, run.failure);
  return fmt::format("{}: error {:.3g}, {:.1f} CPU seconds", which, run.measured.error, run.measured.cpu_seconds);
}

}  // namespace

bool CaseResult::failed() const {
  return std::any_of(runs.begin(), runs.end(), [](const Run& run) { return run.failed(); });
}

void run_suite(const std::vector<Case>& cases, bool quick, unsigned threads, Progress& progress,
               const std::function<void(CaseResult)>& done) {
  std::vector<CaseResult> results;
  std::vector<Place> places;
  for (const Case& problem : cases) {
    results.push_back({problem, {}});
    for (std::size_t m = 0; m < problem.methods.size(); ++m)
      for (const double resolution : quick ? problem.quick : problem.full) {
        places.push_back({results.size() - 1, results.back().runs.size()});
        results.back().runs.push_back({.method = m, .resolution = resolution});
      }
  }
  std::vector<std::size_t> left;  // runs of each case
  for (const CaseResult& result : results) left.push_back(result.runs.size());

  const auto run = [&](std::size_t k) {
    perform(results[places[k].problem].problem, results[places[k].problem].runs[places[k].run]);
  };
  const auto finished = [&](std::size_t k) {
    CaseResult& result = results[places[k].problem];
    progress.message(describe(result.problem, result.runs[places[k].run]));
    if (--left[places[k].problem] == 0) done(std::move(result));
  };
  run_jobs(places.size(), threads, progress, run, finished);
}

}  // namespace smelt
