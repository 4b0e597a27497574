#pragma once
// Who is next to whom on a closed mesh.

#include "core/geometry/triangle_mesh.h"

#include <cstdint>
#include <vector>

namespace smelt {

/// Neighbours of vertex v: neighbour[begin[v]] .. neighbour[begin[v + 1] - 1], in the order of the faces, each once;
/// face n is (v, neighbour[n], third[n]).
struct VertexNeighbours {
  std::vector<std::uint32_t> begin;  ///< one more than there are vertices
  std::vector<std::uint32_t> neighbour, third;
};

/// For a closed oriented mesh, where every edge out of a vertex is the first edge of exactly one corner of a face.
VertexNeighbours find_vertex_neighbours(const TriangleMesh& mesh);

/// Connected pieces of a mesh.
struct MeshComponents {
  std::vector<std::uint32_t> of_vertex;  ///< numbered from 0 in the order of their first vertex
  std::uint32_t count = 0;
};

MeshComponents find_components(const TriangleMesh& mesh);

}  // namespace smelt
