#pragma once
// run.json: what a run did, frame by frame and stage by stage.

#include "core/sph/diagnostics.h"
#include "core/sph/time_step.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace smelt {

/// The steps between two frames.
struct StepStatistics {
  int n_steps = 0;
  double min_dt = 0.0, max_dt = 0.0, total_dt = 0.0;  ///< [s]
  std::array<int, n_time_step_terms> n_by_term{};     ///< how many steps each term set

  void add(const TimeStep& step);
};

/// What a stage cost for one frame.
struct StageCost {
  double seconds = 0.0;
  std::uintmax_t bytes = 0;  ///< written
};

/// Keeps run.json up to date: each set_... replaces that stage of that frame and saves, so that a killed run leaves a true report.
class RunReport {
 public:
  /// Goes on from an existing report where `keep` is set and there is a readable one.
  RunReport(std::filesystem::path path, bool keep);
  ~RunReport();

  void set_run(const std::string& scene_text, std::uint64_t scene_hash, double spacing, double body_volume);
  void set_simulated(int frame, double time, const StepStatistics& steps, const Diagnostics<3>& diagnostics, const StageCost& cost);
  void set_surfaced(int frame, double volume, std::size_t n_vertices, std::size_t n_triangles, const StageCost& cost);
  void set_rendered(int frame, const StageCost& cost);
  void save();

 private:
  struct Document;
  std::filesystem::path path_;
  std::unique_ptr<Document> document_;
};

}  // namespace smelt
