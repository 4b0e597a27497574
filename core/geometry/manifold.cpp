#include "core/geometry/manifold.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace smelt {

namespace {

/// The other two corners of a face at a vertex.
using Wedge = std::array<std::uint32_t, 2>;

/// Fans among the wedges of one vertex: wedges that share a corner share an edge.
std::size_t count_fans(std::vector<Wedge>& wedges) {
  std::vector<std::size_t> fan(wedges.size());
  std::iota(fan.begin(), fan.end(), std::size_t{0});
  std::size_t n = wedges.size();
  for (std::size_t a = 0; a < wedges.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const bool touch =
          std::find_first_of(wedges[a].begin(), wedges[a].end(), wedges[b].begin(), wedges[b].end()) != wedges[a].end();
      if (!touch || fan[a] == fan[b]) continue;
      std::replace(fan.begin(), fan.end(), std::max(fan[a], fan[b]), std::min(fan[a], fan[b]));
      --n;
    }
  return n;
}

}  // namespace

std::size_t count_nonmanifold_vertices(const TriangleMesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  std::vector<std::uint32_t> begin(n + 1, 0);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) ++begin[v + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Wedge> wedges(3 * mesh.triangles.size());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (const auto& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) wedges[next[t[i]]++] = {t[(i + 1) % 3], t[(i + 2) % 3]};
  std::size_t count = 0;
  std::vector<Wedge> mine;
  for (std::size_t v = 0; v < n; ++v) {
    mine.assign(wedges.begin() + begin[v], wedges.begin() + begin[v + 1]);
    count += mine.size() > 1 && count_fans(mine) > 1;
  }
  return count;
}

}  // namespace smelt
