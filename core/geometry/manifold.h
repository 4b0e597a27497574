#pragma once
// Whether a mesh is a surface at its vertices too, which the counts of its edges cannot tell.

#include "core/geometry/triangle_mesh.h"

namespace smelt {

/// Vertices at which faces meet in more than one fan: two pieces that touch in a point, say. Faces of one fan share
/// edges.
std::size_t count_nonmanifold_vertices(const TriangleMesh& mesh);

}  // namespace smelt
