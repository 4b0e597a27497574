#pragma once
// A closed mesh as the voxels near it, each with its signed distance and the nearest point of the mesh.

#include "core/geometry/triangle_mesh.h"

#include <array>
#include <cstdint>
#include <vector>

namespace smelt {

/// A block of 8 x 8 x 8 voxels, laid out as an OpenVDB leaf node: z fastest. Voxel (i, j, k) is the point (i, j, k)
/// voxel_size.
struct BandBlock {
  static constexpr int width = 8;
  static constexpr std::int32_t outside_band = -1;

  std::array<std::int32_t, 3> origin;
  std::array<float, 512> distance;     ///< [voxels], negative inside
  std::array<std::int32_t, 512> face;  ///< nearest face; outside_band where the distance is not below the half-width
  std::array<std::array<float, 2>, 512>
      w;  ///< barycentric weights of the face's second and third corner at the nearest point
};

/// All voxels nearer than `half_width` voxels to `mesh` (metres), in blocks ordered by origin. Distances are exact but
/// for rounding; inside is where the winding number differs from zero, so touching and overlapping parts do no harm. Of
/// two nearest faces at the same distance the one with the lower index counts. OpenVDB's meshToVolume leaves that
/// to the order of threads, and both the signs and the band that it grows from there depend on it.
std::vector<BandBlock> compute_narrow_band(const TriangleMesh& mesh, double voxel_size, float half_width);

}  // namespace smelt
