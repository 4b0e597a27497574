#pragma once
// The algebraic surface called "chair", which [P figure 6.14] lets flow over the skeleton of a hand.

#include "core/geometry/triangle_mesh.h"

namespace smelt {

/// (x^2 + y^2 + z^2 - a k^2)^2 - b ((z - k)^2 - 2 x^2) ((z + k)^2 - 2 y^2) = 0 with k = 5, a = 0.95, b = 0.8, on cells
/// of `cell`: four lobes at the corners of a tetrahedron, joined by six arms.
TriangleMesh make_chair(double cell);

}  // namespace smelt
