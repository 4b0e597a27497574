#pragma once
// `smelt report`: speed against error.

#include "bench/cases/case.h"
#include "scenes/progress.h"

#include <filesystem>
#include <string>
#include <vector>

namespace smelt {

struct ReportOptions {
  std::vector<std::string> names;      ///< of cases; empty: all
  bool quick = false;                  ///< coarse resolutions: three minutes on two cores; else forty
  std::filesystem::path folder;        ///< for index.html, runs.csv and profile_CASE.csv
  std::filesystem::path expected;      ///< stored errors
  bool check = false;                  ///< compare with them
  bool write_expected = false;         ///< store them anew
  unsigned threads = 1;                ///< runs at a time
  std::string command;                 ///< to stand in the page
};

/// The cases of those names, in the order of `all`; all where there are none. Throws Error with the names that there are, and the nearest to what was meant.
std::vector<Case> choose_cases(const std::vector<Case>& all, const std::vector<std::string>& names);

/// Runs the cases and writes page and CSV, anew after each case. A case that fails is stated in them, and does not stop the others. Throws Error
/// where nothing can be drawn or written, where `check` is set and an error is worse than stored, and where neither is asked for
/// and a case failed: after all is written.
void make_report(const std::vector<Case>& cases, const ReportOptions& options, Progress& progress);

}  // namespace smelt
