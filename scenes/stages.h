#pragma once
// The three stages of a shot. Each reads what the earlier one left in the folder and writes frame by frame, so that any range of
// frames can be made, in any order, and again.

#include "scenes/output_folder.h"
#include "scenes/progress.h"
#include "scenes/run_report.h"
#include "scenes/scene.h"

#include <optional>
#include <string>

namespace smelt {

struct FrameRange {
  int first = 1;
  int last = 1;
};

struct StageOptions {
  FrameRange frames;
  bool resume = false;  ///< keep what is there and was made from the same settings
};

/// Simulates up to options.frames.last and writes particles and a checkpoint for every frame. With `resume` it goes on from the last
/// sound checkpoint, and ends in the same bytes as a run that was never cut off. Throws Error where that checkpoint is of another
/// scene, DivergedError (frames finished are kept), Interrupted.
void simulate_frames(const Scene& scene, const OutputFolder& folder, const StageOptions& options, RunReport& report, Progress& progress);

/// Wraps the particles of each frame in a surface: OBJ and VDB. Throws Error for a frame whose particles are missing.
void surface_frames(const Scene& scene, const OutputFolder& folder, const StageOptions& options, RunReport& report, Progress& progress);

/// Draws each frame as PNG. Throws Error for a frame whose surface is missing.
void render_frames(const Scene& scene, const OutputFolder& folder, const StageOptions& options, RunReport& report, Progress& progress);

}  // namespace smelt
