#pragma once
// The skeleton of a right hand on its forearm, palm up, of our own making: bones are capsules with thick ends.

#include "core/geometry/triangle_mesh.h"

namespace smelt {

/// 1.18 high, from y = -0.004 (the knobs of the forearm, on y = 0 but for that) to 1.177; the palm faces up and towards
/// +z, the fingers spread and curl upwards. One closed piece, on cells of `cell`. Lengths without a unit.
TriangleMesh make_hand(double cell);

}  // namespace smelt
