#pragma once
// The stability page: hard cases at several time steps, and a map over time step and jump number.

#include "bench/cases/watch.h"
#include "bench/report/page.h"
#include "scenes/progress.h"

#include <filesystem>
#include <string>
#include <vector>

namespace smelt {

/// How a scene fared at one CFL factor.
struct Trial {
  double courant = 0.0;      ///< C of the time step
  Watched seen = {};         ///< the worst on the way
  std::string failure = {};  ///< why the solver gave up; empty where it did not

  /// Whether it ended, and no more energy than extremes::energy_bar came from nowhere.
  bool held() const;
  double mean_step() const { return seen.time / seen.steps; }  ///< [s]
};

struct HardCaseResult {
  std::string name;
  std::vector<Trial> trials;  ///< CFL factors ascending

  const Trial* at(double courant) const;  ///< nullptr where it was not tried
};

/// A creeping block of jump number `jump` for some hundred steps.
struct MapCell {
  double jump = 0.0;
  bool relaxed = false;  ///< the stress has a memory; else it follows the strain rate at once, the explicit method
  Trial trial;
};

struct Stability {
  std::vector<HardCaseResult> cases;
  std::vector<MapCell> map;
};

/// Runs them, as run_jobs does.
Stability probe_stability(bool quick, unsigned threads, Progress& progress);

/// A table of the hard cases and the maps of both methods. Draws with gnuplot in `folder`.
Section write_stability_section(const Stability& stability, bool quick, const std::filesystem::path& folder);

/// The hard cases that did not hold at the usual CFL factor, a line each.
std::vector<std::string> failures(const Stability& stability);

/// One row a trial.
std::string write_stability_csv(const Stability& stability);

}  // namespace smelt
