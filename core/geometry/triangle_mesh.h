#pragma once
// An indexed triangle mesh and the measures that decide what it can be used for.

#include "core/geometry/vec.h"

#include <array>
#include <cstdint>
#include <vector>

namespace smelt {

/// Vertices in metres; triangles as vertex indices, counter-clockwise seen from outside (docs/conventions.md).
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// What is wrong, or right, with the connectivity of a mesh.
struct MeshTopology {
  std::size_t n_boundary_edges = 0;       ///< edges with one face
  std::size_t n_nonmanifold_edges = 0;    ///< edges with three faces or more
  std::size_t n_misoriented_edges = 0;    ///< edges that their two faces run through in the same direction
  std::size_t n_degenerate_faces = 0;     ///< faces with a repeated vertex
  std::size_t n_components = 0;           ///< connected by shared vertices
  std::int64_t euler_characteristic = 0;  ///< vertices in use - edges + faces
  /// Closed, oriented 2-manifold as far as its edges can tell.
  bool closed() const {
    return n_boundary_edges == 0 && n_nonmanifold_edges == 0 && n_misoriented_edges == 0 && n_degenerate_faces == 0;
  }
};

/// Signed volume [m^3] by the divergence theorem, sum of det(a, b, c)/6; positive when faces wind outward. Meaningful
/// for a closed mesh only.
double compute_volume(const TriangleMesh& mesh);

/// Total area [m^2].
double compute_area(const TriangleMesh& mesh);

Box3 compute_bounds(const TriangleMesh& mesh);

MeshTopology compute_topology(const TriangleMesh& mesh);

/// Merges vertices closer than `tolerance` [m] to one another, drops faces that lose a corner by it, duplicate faces
/// and vertices that no face uses. Order of first appearance is kept.
TriangleMesh weld(const TriangleMesh& mesh, double tolerance);

}  // namespace smelt
