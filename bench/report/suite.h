#pragma once
// Runs cases at their resolutions.

#include "bench/cases/case.h"
#include "scenes/progress.h"

#include <functional>
#include <string>
#include <vector>

namespace smelt {

/// A run, or why there is none.
struct Run {
  std::size_t method = 0;
  double resolution = 0.0;
  Measurement measured = {};
  std::string failure = {};  ///< empty where it went well

  bool failed() const { return !failure.empty(); }
};

struct CaseResult {
  Case problem;
  std::vector<Run> runs;  ///< method by method, resolutions ascending

  bool failed() const;
};

/// Runs all methods of the cases at their quick or full resolutions as run_jobs does, and calls `done` with each case
/// as its last run ends. A run that throws is a failure of that run alone.
void run_suite(const std::vector<Case>& cases, bool quick, unsigned threads, Progress& progress,
               const std::function<void(CaseResult)>& done);

}  // namespace smelt
