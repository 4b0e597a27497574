#pragma once
// Surfaces as Wavefront OBJ: positions and normals, one normal per vertex.

#include "core/geometry/surface_mesh.h"

#include <filesystem>
#include <span>

namespace smelt {

/// Writes positions (rounded to float, shortest text that reads back as the same float), normals and faces ("f a//a",
/// counted from 1) under a comment that gives the counts. Formatted in parallel; the same bytes on any thread count.
/// Where there are `colours`, one per vertex, red green blue in [0, 1] follow each position, as most programs read
/// them. Atomic. Throws Error where the file cannot be written or a coordinate is not finite. `surface.normals` has one
/// entry per vertex.
void write_obj(const std::filesystem::path& path, const SurfaceMesh& surface, std::span<const Vec3f> colours = {});

/// Reads what write_obj wrote, many times faster than import_mesh; colours are skipped; velocity, temperature and
/// viscosity stay empty (see read_surface). Only triangles; where normals are given, each vertex has the normal of the
/// same index. Throws Error with path and line number on anything else, on an index out of range, and where the counts
/// in the leading comment are not met (a truncated file).
SurfaceMesh read_obj(const std::filesystem::path& path);

/// Whether write_obj() wrote this file for a surface without triangles. Throws Error where it cannot be read.
bool is_empty_surface(const std::filesystem::path& path);

}  // namespace smelt
