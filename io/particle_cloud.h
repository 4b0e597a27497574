#pragma once
// Particle clouds of other programs: PLY, XYZ, CSV.

#include "core/geometry/vec.h"

#include <filesystem>
#include <string>
#include <vector>

namespace smelt {

/// Fields are empty where the file has none.
struct ParticleCloud {
  std::vector<Vec3> position;       ///< [m]
  std::vector<Vec3f> velocity;      ///< [m/s]
  std::vector<float> density;       ///< [kg/m^3]
  std::vector<float> temperature;   ///< [K]
  std::vector<float> viscosity;     ///< [Pa s]
  std::vector<std::string> unused;  ///< names of the file's other columns
};

/// Whether the name of a file says that `read_particle_cloud` reads it: .ply, .xyz, .csv.
bool is_particle_cloud(const std::filesystem::path& path);

/// Reads particles; units are taken to be SI, axes as they are.
/// PLY: element `vertex`, ascii or binary, properties x y z and, any of them, vx vy vz, density, temperature,
/// viscosity, of any number type. CSV: the first row names the columns, as for PLY, or as ParaView does ("Points:0",
/// "Points_0", "v:0", "velocity_0"); separated by comma, semicolon or tab. XYZ: three numbers a line. Lines that begin
/// with # are comments. Throws Error with the path, and the line or the particle (from 0), where a file is missing or
/// damaged, x, y or z is not there, one of a vector's components is missing, a number is not finite, a density not
/// positive, or there is no particle.
ParticleCloud read_particle_cloud(const std::filesystem::path& path);

}  // namespace smelt
