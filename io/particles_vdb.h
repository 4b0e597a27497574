#pragma once
// The particles of a frame as an OpenVDB Points file.

#include "core/sph/particle_frame.h"

#include <filesystem>

namespace smelt {

/// Writes one PointDataGrid `points` with attributes P, v, density, id and, where the frame has them, temperature,
/// viscosity, mass (of each, where they differ) and rest, all of them floats as they are. creator, frame, time, mass,
/// spacing and smoothing_length are grid metadata. Voxels are four spacings wide and positions are floats within their
/// voxel: they come back to 1.2e-7 of the spacing, however far from the origin. The same bytes on any thread count and
/// for any order of the particles. Atomic. Throws Error where the file cannot be written; fields are all of the same
/// length, ids differ.
void write_particles(const std::filesystem::path& path, const ParticleFrame& particles);

/// Reads what write_particles wrote, ordered by id. Throws Error with the path where the file is missing, damaged or
/// not from smelt, naming the grid, attribute or metadata that it lacks.
ParticleFrame read_particles(const std::filesystem::path& path);

}  // namespace smelt
