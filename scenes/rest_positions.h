#pragma once
// Where particles were before the material moved: the coordinates of textures that move with it.

#include "core/sph/particle_frame.h"
#include "core/sph/solver.h"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace smelt {

/// Follows the particles of a shot from frame to frame. A body's particle rests where it starts. What a vent pours in
/// rests in the unmoved column that the vent would push out, x - u (t - start): u the velocity in the duct, x where it
/// is first seen, at time t. That is exact for what is seen in the duct, and off by what it has strayed from its
/// straight way for what leaves it within a frame.
class RestPositions {
 public:
  explicit RestPositions(const SolverParameters<3>& parameters);

  /// Overwrites `frame.rest`: known for particles seen before, made for new ones. Frames in order, without gaps.
  void set_rest(ParticleFrame& frame);

  /// Goes on from a frame that set_rest() was given before the shot was cut off. Throws Error where it has no rest
  /// positions.
  void take_over(const ParticleFrame& frame);

 private:
  struct Vent {
    Vec3 position, velocity;
    double start = 0.0;
  };
  Vec3 column_position(const Vec3& x, double time) const;

  std::vector<Vent> vents_;
  std::unordered_map<std::int32_t, Vec3f> known_;
};

}  // namespace smelt
