#pragma once
// Patterns in space, without an image.

#include "core/geometry/vec.h"

#include <cstdint>

namespace smelt {

/// Smooth noise about 0, mostly within [-0.7, 0.7], with features of size 1: gradients hashed at lattice points,
/// blended by a quintic [Perlin 2002]. Twice differentiable; 0 at lattice points.
float gradient_noise(const Vec3f& x);

/// `octaves` of gradient_noise, each of half the size and half the height of the one before.
float fractal_noise(const Vec3f& x, int octaves);

/// Cells about random points, one in every unit cube [Worley 1996].
struct CellSample {
  float edge = 0.0f;       ///< half the difference of the distances to the two nearest points: 0 at edges
  std::uint32_t cell = 0;  ///< hash of the nearest point
};
CellSample cell_noise(const Vec3f& x);

}  // namespace smelt
