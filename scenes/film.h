#pragma once
// The frames as a film.

#include "scenes/output_folder.h"

#include <filesystem>
#include <optional>
#include <string>

namespace smelt {

/// Encodes frames 1..n_frames as <folder>/<name>.mp4 with ffmpeg. Nothing where ffmpeg is not installed, a frame is
/// missing or ffmpeg fails: the frames are the result, the film a convenience; `why_not` then says which.
std::optional<std::filesystem::path> encode_film(const OutputFolder& folder, const std::string& name, int n_frames,
                                                 double fps, std::string& why_not);

}  // namespace smelt
