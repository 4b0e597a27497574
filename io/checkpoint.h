#pragma once
// The exact state of a simulation at the end of a frame, for a resume to the same bytes.

#include "core/sph/open_boundary.h"
#include "core/sph/particles.h"
#include "core/sph/rigid_body.h"

#include <cstdint>
#include <filesystem>

namespace smelt {

struct Checkpoint {
  std::int32_t frame = 0;        ///< the finished frame whose state this is
  double time = 0.0;             ///< [s]
  std::uint64_t scene_hash = 0;  ///< of what the simulation depends on
  Particles<3> particles;
  ParticleAccount account;
  std::vector<BodyState<3>> bodies;  ///< rigid bodies, in the order of their colliders
};

/// Writes all arrays bit by bit, with a hash of them at the end. Atomic. Throws Error.
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// Throws Error with the path where the file is missing, damaged, or of another version.
Checkpoint read_checkpoint(const std::filesystem::path& path);

}  // namespace smelt
