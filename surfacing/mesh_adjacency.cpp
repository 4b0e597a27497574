#include "surfacing/mesh_adjacency.h"

#include <numeric>

namespace smelt {

VertexNeighbours find_vertex_neighbours(const TriangleMesh& mesh) {
  VertexNeighbours out;
  out.begin.assign(mesh.vertices.size() + 1, 0);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) ++out.begin[v + 1];
  std::partial_sum(out.begin.begin(), out.begin.end(), out.begin.begin());
  out.neighbour.resize(3 * mesh.triangles.size());
  out.third.resize(3 * mesh.triangles.size());
  std::vector<std::uint32_t> next(out.begin.begin(), out.begin.end() - 1);
  for (const auto& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t at = next[t[i]]++;
      out.neighbour[at] = t[(i + 1) % 3];
      out.third[at] = t[(i + 2) % 3];
    }
  return out;
}

MeshComponents find_components(const TriangleMesh& mesh) {
  // Union-find whose roots are the lowest vertices, so that numbering follows the first vertex of each piece.
  const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
  std::vector<std::uint32_t> parent(n);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& t : mesh.triangles)
    for (int i = 0; i < 2; ++i) {
      const std::uint32_t a = root(t[i]), b = root(t[i + 1]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  MeshComponents out;
  out.of_vertex.resize(n);
  for (std::uint32_t v = 0; v < n; ++v) {
    const std::uint32_t r = root(v);
    out.of_vertex[v] = r == v ? out.count++ : out.of_vertex[r];
  }
  return out;
}

}  // namespace smelt
