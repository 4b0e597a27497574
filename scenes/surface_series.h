#pragma once
// Surfaces of particle files without a scene: smelt's own caches, or clouds from other programs.

#include "scenes/progress.h"
#include "scenes/run_scene.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace smelt {

/// A file of particles and the number of its frame.
struct ParticleFile {
  std::filesystem::path path;
  int frame = 1;
};

/// The files that `names` mean, by frame: the names themselves, or one name with # for the digits of the frame number,
/// "cloud.####.ply", which means the files of `frames` ("A-B", "A-", "A"; all that are there where it is empty). The
/// frame of a name is its last run of digits, or its place among the names, from 1. Throws Error for a missing file, a
/// gap between the frames of a pattern, or two files of one frame: nothing is skipped silently.
std::vector<ParticleFile> find_particle_files(const std::vector<std::string>& names, const std::string& frames);

struct SeriesOptions {
  std::filesystem::path folder;        ///< results go to folder/surface
  bool resume = false;                 ///< keep frames that are there, made from the same settings
  std::vector<std::string> overrides;  ///< of keys of [surface]
  std::optional<double> spacing;       ///< between particles [m]; else from the cache, or estimated
  std::optional<std::vector<std::string>>
      attributes;  ///< to carry over, of v, temperature, viscosity; all that are there where not given
};

struct SeriesSummary {
  std::filesystem::path folder;
  int n_made = 0;
  int n_kept = 0;
  double spacing = 0.0;
  bool spacing_is_estimated = false;
};

/// Writes surface.NNNN.obj and .vdb (.ply on request) of every file. All frames of clouds without a spacing get the one
/// estimated from the first file of the series that there is, whichever frames are asked for, so that machines of a
/// farm agree. Densities that a cloud lacks are 1000 kg/m3, which no surface depends on. Throws Error that names the
/// file, and the particle where one is at fault.
SeriesSummary surface_series(const std::vector<std::string>& names, const std::string& frames,
                             const SeriesOptions& options, Progress& progress);

}  // namespace smelt
