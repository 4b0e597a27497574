#pragma once
// The numbers behind the page.

#include "bench/report/suite.h"

#include <string>
#include <vector>

namespace smelt {

/// One row of runs.csv.
struct RunRow {
  std::string problem, method;
  double resolution = 0.0;
  std::size_t n_particles = 0;
  double error = 0.0;
  double cpu_seconds = 0.0;
  std::string failure;  ///< empty where it went well
};

std::vector<RunRow> to_rows(const CaseResult& result);

/// runs.csv: all rows under a line of names, numbers in full precision, texts in quotation marks (doubled inside).
std::string write_runs_csv(const std::vector<RunRow>& rows);

/// Every run's profile, computed and reference, point by point; empty where the case has none.
std::string write_profiles_csv(const CaseResult& result);

}  // namespace smelt
