#pragma once
// Low-pass filter on the shape of a closed mesh.

#include "core/geometry/triangle_mesh.h"
#include "surfacing/mesh_adjacency.h"

#include <span>

namespace smelt {

/// Smooths the vertices of a closed mesh in place and restores the volume of each connected piece.
///
/// One G does what `passes` Jacobi steps x_v += 0.8 s_v (mean of neighbours - x_v) do, s_v = strength[v] in [0, 1], in
/// about 2 sqrt(passes) steps of unequal size; waves of medium length come out up to a tenth of their height elsewhere.
/// Used alone, G shrinks everything; with Tukey's twicing, x' = G x + G (x - G x), a wave that G damps by g is damped
/// by 1 - (1 - g)^2: noise as before, but shapes larger than the noise keep their size to second order. What volume is
/// lost nevertheless is put back piece by piece, by an equal shift of its vertices along their normals, weighted with
/// their strength, to 1e-5 of it; a piece that would lose more than half is moved by a half, a quarter and so on of
/// that way. Where little of a piece has any strength some of the loss may remain: 8 shifts of up to half an edge are
/// made. Connectivity is kept; `near` is that of `mesh`. `strength` has one entry per vertex. Errors: none.
void smooth_mesh(TriangleMesh& mesh, const VertexNeighbours& near, std::span<const float> strength, int passes);

/// Unit vertex normals, the mean of the face normals weighted with face area; outward on an outward mesh.
/// `near` is that of `mesh`, which need not be closed.
std::vector<Vec3f> compute_vertex_normals(const TriangleMesh& mesh, const VertexNeighbours& near);
std::vector<Vec3f> compute_vertex_normals(const TriangleMesh& mesh);

}  // namespace smelt
