#pragma once
// Marching cubes on a sparse field, with the topology of the trilinear interpolant in every cell, faces and interior.

#include "core/geometry/triangle_mesh.h"
#include "surfacing/sparse_field.h"

namespace smelt {

constexpr float tie_lift = 0x1p-16f;

/// The surface where `field` equals `iso` > 0, as a closed mesh that winds outward (inside is where samples are >=
/// iso): every edge has exactly two faces that run through it in opposite directions, no vertex or face occurs twice,
/// every vertex is used.
///
/// A sample at the iso-value is taken to be `tie_lift` iso above it: so small a lift moves nothing that can be seen,
/// and large enough for double precision to decide every face and every tunnel of the lifted interpolant, whose
/// topology the surface has. Saddles at the iso-value: on a face they join (surfacing/cell_deciders.h), in a cell they
/// make no tunnel.
///
/// One vertex per crossed grid edge, at the zero of the linear interpolant, but no nearer than 1 % of the edge to
/// either end: where a sample is (nearly) at the iso-value the vertices of its edges would fall together and their
/// triangles have no area. Which vertices are connected is decided by surfacing/cell_deciders.h. Positions are in
/// metres.
///
/// Requires: the 7 samples one step below each inside sample are in stored blocks, or in `deep` ones next to inside
/// samples only (`compute_chi` sees to that); otherwise InternalError. Throws Error beyond 2^32/3 triangles.
/// Vertices and faces are ordered by block and by
/// cell, on any number of threads.
TriangleMesh extract_iso_surface(const SparseField& field, float iso);

}  // namespace smelt
