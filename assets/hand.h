#pragma once
// The skeleton of a right hand on its forearm, palm up, of our own making: bones are capsules with thick ends.

#include "core/geometry/triangle_mesh.h"

namespace smelt {

/// Stands on y = 0, about 1.2 high; the palm faces up and towards +z, the fingers spread and curl upwards. One closed
/// piece, on cells of `cell`.
TriangleMesh make_hand(double cell);

}  // namespace smelt
