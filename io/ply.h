#pragma once
// Surfaces as binary PLY, with what OBJ cannot hold.

#include "core/geometry/surface_mesh.h"

#include <filesystem>

namespace smelt {

/// Writes little-endian floats per vertex: x y z (m), nx ny nz, vx vy vz (m/s) and, where the surface has them,
/// `temperature` (K) and `viscosity` (Pa s); faces as "list uchar int vertex_indices". The same bytes on any thread
/// count. Atomic. Throws Error where the file cannot be written, a value is not finite, or there are more than 2^31 - 1
/// vertices.
void write_ply(const std::filesystem::path& path, const SurfaceMesh& surface);

}  // namespace smelt
