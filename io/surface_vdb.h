#pragma once
// A surface as OpenVDB grids: a level set, with the fluid's velocity and temperature in a band around it.

#include "core/geometry/surface_mesh.h"

#include <cstdint>
#include <filesystem>

namespace smelt {

/// Writes the level set `surface` of a closed mesh (distance in metres, negative inside, band of three voxels each
/// way), the grid `v` (m/s; vector type "contravariant relative") and, where the mesh has them, `temperature` (K),
/// `viscosity` (Pa s) and `rest` (m). All are active on the band of `surface`; a voxel holds the value at the nearest
/// point of the mesh. With `fog_volume` also the fog volume `density`, 1 inside, falling to 0 at the surface over three
/// voxels. creator, frame and time are metadata of each grid, half_width_voxels of `surface`. `voxel_size` in metres.
/// The same bytes on any thread count. Atomic. Throws Error where the file cannot be written.
void write_surface_vdb(const std::filesystem::path& path, const SurfaceMesh& surface, double voxel_size,
                       std::int32_t frame, double time, bool fog_volume = false);

/// The surface of a frame put together again: positions and normals from the OBJ file, velocity and (where present)
/// temperature, viscosity and rest position sampled from the grids at the vertices (trilinear). Throws Error where a
/// file is missing or damaged, the grid `v` is missing, or a vertex lies outside the band (the files are not of the
/// same frame).
SurfaceMesh read_surface(const std::filesystem::path& obj_path, const std::filesystem::path& vdb_path);

}  // namespace smelt
