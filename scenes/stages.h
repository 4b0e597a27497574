#pragma once
// The three stages of a shot. Each reads what the earlier one left in the folder and writes frame by frame, so that any
// range of frames can be made, in any order, and again.

#include "scenes/output_folder.h"
#include "scenes/progress.h"
#include "scenes/run_report.h"
#include "scenes/scene.h"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace smelt {

struct FrameRange {
  int first = 1;
  int last = 1;
};

struct StageOptions {
  FrameRange frames;
  bool resume = false;  ///< keep what is there and was made from the same settings
};

/// Simulates up to options.frames.last and writes particles and a checkpoint for every frame. With `resume` it goes on
/// from the last sound checkpoint, and ends in the same bytes as a run that was never cut off; without, an earlier
/// result in the folder is first moved aside to <folder>.1, .2, ... Before anything is moved or written throws Error
/// where the simulation cannot be built, the last checkpoint is of another scene, frames are there but no checkpoints,
/// files that no run wrote are in the way, or the folder to be moved holds the scene, its meshes or the current folder.
/// Throws DivergedError (frames finished are kept), Interrupted.
void simulate_frames(const Scene& scene, const OutputFolder& folder, const StageOptions& options, RunReport& report,
                     Progress& progress);

/// Wraps the particles of each frame in a surface: OBJ and VDB. A frame that cannot be
/// surfaced does not keep the others from it: Error at the end names the first, as of one whose particles are missing.
void surface_frames(const Scene& scene, const OutputFolder& folder, const StageOptions& options, RunReport& report,
                    Progress& progress);

/// Draws each frame as PNG, and as EXR where the scene asks for it. A frame that cannot be drawn is told and left out;
/// the others are made, and at the end Error is thrown.
void render_frames(const Scene& scene, const OutputFolder& folder, const StageOptions& options, RunReport& report,
                   Progress& progress);

/// Pictures asked for on the command line instead of the scene's.
struct PictureRequest {
  bool diagnostic = false;
  std::string colour_by = "temperature";           ///< or viscosity, density, speed, pressure
  std::optional<std::pair<double, double>> range;  ///< of the colours; the values' own over the frames where not given
  std::string overlay = "none";                    ///< of the surface: or wire, translucent
  int sheet_columns = 0, sheet_rows = 0;           ///< of a contact sheet; 0: none
};

/// Draws the particles of each frame as coloured spheres, like render_frames().
void diagnose_frames(const Scene& scene, const OutputFolder& folder, const FrameRange& frames,
                     const PictureRequest& request, Progress& progress);

/// Frames for a sheet of columns x rows places: evenly spread over the range, first and last included.
std::vector<int> choose_sheet_frames(const FrameRange& frames, int n);

/// Puts the pictures of chosen frames, drawn before, on one page in the folder. Throws Error where one is missing.
std::filesystem::path write_sheet(const OutputFolder& folder, const FrameRange& frames, const PictureRequest& request);

}  // namespace smelt
