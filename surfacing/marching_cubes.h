#pragma once
// Marching cubes on a sparse field, with the topology of the trilinear interpolant in every cell, faces and interior.

#include "core/geometry/triangle_mesh.h"
#include "surfacing/sparse_field.h"

namespace smelt {

/// The surface where `field` equals `iso` > 0, as a closed mesh that winds outward (inside is where samples are >=
/// iso): every edge has exactly two faces that run through it in opposite directions, no vertex or face occurs twice,
/// every vertex is used.
///
/// One vertex per crossed grid edge, at the zero of the linear interpolant, but no nearer than 1 % of the edge to
/// either end: where a sample is (nearly) at the iso-value the vertices of its edges would fall together and their
/// triangles have no area. Which vertices are connected is decided by surfacing/cell_deciders.h. Positions are in
/// metres.
///
/// Requires: the 7 samples one step below each inside sample are in stored blocks, or in `deep` ones next to inside
/// samples only (`compute_chi` sees to that); otherwise InternalError. Vertices and faces are ordered by block and by cell, on any number of threads.
TriangleMesh extract_iso_surface(const SparseField& field, float iso);

}  // namespace smelt
