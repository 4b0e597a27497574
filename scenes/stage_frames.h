#pragma once
// What the stages share: files of a frame, their cost, skipping what is done.

#include "core/error.h"
#include "scenes/stages.h"

#include <chrono>
#include <filesystem>
#include <vector>

namespace smelt {

/// Measures the cost of one frame of a stage.
class CostMeter {
 public:
  StageCost finish(const std::vector<std::filesystem::path>& written) const {
    StageCost cost;
    cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    for (const auto& path : written) cost.bytes += std::filesystem::file_size(path);
    return cost;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

inline bool all_exist(const std::vector<std::filesystem::path>& paths) {
  for (const auto& path : paths)
    if (!std::filesystem::exists(path)) return false;
  return true;
}

/// Throws Interrupted where the user wants to stop.
inline void stop_if_asked(Progress& progress, const char* stage, int frame) {
  if (!progress.should_stop()) return;
  throw Interrupted(fmt::format(
      "stopped while working on frame {} of stage \"{}\"; finished frames are kept, --resume goes on from them", frame,
      stage));
}

}  // namespace smelt
