#pragma once
// A whole shot: read -> seed -> advance -> surface -> render.

#include "scenes/stages.h"

#include <filesystem>
#include <optional>
#include <string>

namespace smelt {

struct RunOptions {
  std::filesystem::path folder;      ///< empty: out/<name of the shot>
  std::optional<FrameRange> frames;  ///< to make; all where not given
  bool resume = false;
  PictureRequest pictures;  ///< for Stage::render
};

/// What a run made.
struct RunSummary {
  OutputFolder folder;
  FrameRange frames;
  double simulate_seconds = 0.0;
  double surface_seconds = 0.0;
  double render_seconds = 0.0;
  std::optional<std::filesystem::path> sheet = std::nullopt;
  std::optional<std::filesystem::path> film = std::nullopt;  ///< where ffmpeg is installed and all frames are there
};

/// Simulates, surfaces and renders. Without `resume`, an earlier result in the folder is first moved aside, once
/// nothing can be refused any more, to <folder>.1, .2, ...
RunSummary run_scene(const Scene& scene, const RunOptions& options, Progress& progress);

/// One stage, from what the earlier ones left in the folder.
enum class Stage { simulate, surface, render };
RunSummary run_stage(const Scene& scene, Stage stage, const RunOptions& options, Progress& progress);

/// Reads "A-B", "A-" or "A" within 1..last. Throws Error.
FrameRange parse_frame_range(const std::string& text, int last);

}  // namespace smelt
