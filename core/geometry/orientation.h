#pragma once
// Faces that are to look the same way as their neighbours.

#include "core/geometry/triangle_mesh.h"

namespace smelt {

/// What orient() found and did.
struct Orientation {
  std::size_t n_dropped = 0;  ///< faces with the three corners of another one, whichever way round
  std::size_t n_turned = 0;   ///< faces turned round
  bool orientable = true;     ///< false: some part has one side only, as a Moebius strip has; it is left as it was
};

/// Drops faces that lie on another one and winds the rest alike wherever two meet at an edge that is theirs alone. Of
/// each part that hangs together by such edges the larger area stays as it was; which side is out it does not ask.
Orientation orient(TriangleMesh& mesh);

/// The sum of the faces' areas as vectors [m^2]: 0 for a closed mesh; of an open one, the side it looks to.
Vec3 compute_vector_area(const TriangleMesh& mesh);

}  // namespace smelt
