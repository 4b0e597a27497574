#pragma once
// `smelt report`: speed against error.

#include "bench/cases/case.h"
#include "scenes/progress.h"

#include <filesystem>
#include <string>
#include <vector>

namespace smelt {

struct ReportOptions {
  std::vector<std::string> names;  ///< of cases, and "stability"; empty: all
  bool quick = false;              ///< coarse resolutions: three minutes on two cores; else 22
  std::filesystem::path folder;    ///< for index.html, runs.csv, profile_CASE.csv, stability.csv
  std::filesystem::path expected;  ///< stored errors
  bool check = false;              ///< compare with them
  bool write_expected = false;     ///< store them anew
  unsigned threads = 1;            ///< runs at a time
  std::string command;             ///< to stand in the page
};

/// What is to be run.
struct Selection {
  std::vector<Case> cases;
  bool stability = false;  ///< the stability page too
};

/// The cases of those names, in the order of `all`, and the stability page where "stability" is among them; everything
/// where there are no names. Throws Error with the names that there are, and the nearest to what was meant.
Selection select(const std::vector<Case>& all, const std::vector<std::string>& names);

/// Runs them and writes page and CSV, anew after each case. A case that fails is stated in them, and does not stop the
/// others. Throws Error where nothing can be drawn or written, where `check` is set and an error is worse than stored,
/// and where neither is asked for and a case failed: after all is written.
void make_report(const Selection& selection, const ReportOptions& options, Progress& progress);

}  // namespace smelt
