#pragma once
// What the grids of any OpenVDB file are, without their values.

#include "core/geometry/vec.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace smelt {

struct GridSummary {
  std::string name;
  bool is_of_smelt = false;  ///< as its creator says
  std::string value_type;    ///< "float", "vec3s", "ptdataidx32", ...
  std::string grid_class;    ///< "level set", "fog volume", "staggered" or "unknown"
  double voxel_size = 0.0;   ///< [m], along x
  double background = 0.0;   ///< of float grids
  std::uint64_t n_active = 0;
  Box3 bounds;                                                ///< of the active voxels [m]; empty where there are none
  std::vector<std::pair<std::string, std::string>> metadata;  ///< creator, frame and what else the writer said, as text
};

/// Throws Error with the path where the file is missing or damaged.
std::vector<GridSummary> summarise_vdb(const std::filesystem::path& path);

}  // namespace smelt
