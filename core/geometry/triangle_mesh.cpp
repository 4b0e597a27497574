#include "core/geometry/triangle_mesh.h"

#include "core/error.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <set>
#include <unordered_map>

namespace smelt {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

bool is_degenerate(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// One side of one face: its vertices in ascending order, and whether the face runs through them in that order.
struct HalfEdge {
  std::uint32_t low, high;
  bool ascending;
};

std::vector<HalfEdge> collect_half_edges(const TriangleMesh& mesh) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    if (is_degenerate(t)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  }
  std::sort(edges.begin(), edges.end(),
            [](const HalfEdge& p, const HalfEdge& q) { return p.low != q.low ? p.low < q.low : p.high < q.high; });
  return edges;
}

/// Union-find over vertices.
class Components {
 public:
  explicit Components(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::uint32_t{0}); }
  std::uint32_t find(std::uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Finds, among the points kept so far, one within the tolerance: a hash of cells one tolerance wide.
class PointGrid {
 public:
  explicit PointGrid(double tolerance) : tolerance_(tolerance) {}

  /// Index of the earliest point kept within the tolerance; keeps `p` under `index` where there is none.
  std::uint32_t find_or_keep(const Vec3& p, std::uint32_t index) {
    const Cell cell = cell_of(p);
    std::uint32_t found = index;
    const std::int64_t reach = tolerance_ > 0.0 ? 1 : 0;
    for (std::int64_t dz = -reach; dz <= reach; ++dz)
      for (std::int64_t dy = -reach; dy <= reach; ++dy)
        for (std::int64_t dx = -reach; dx <= reach; ++dx) {
          const auto [first, last] = points_.equal_range({cell[0] + dx, cell[1] + dy, cell[2] + dz});
          for (auto it = first; it != last; ++it)
            if (it->second.index < found && (it->second.point - p).norm() <= tolerance_) found = it->second.index;
        }
    if (found == index) points_.emplace(cell, Kept{p, index});
    return found;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Kept {
    Vec3 point;
    std::uint32_t index;
  };
  struct CellHash {
    std::size_t operator()(const Cell& c) const {
      std::uint64_t h = 0;
      for (const std::int64_t x : c) {
        h = (h ^ static_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15ULL;
        h ^= h >> 32;
      }
      return h;
    }
  };

  Cell cell_of(const Vec3& p) const {
    Cell cell{};
    for (int k = 0; k < 3; ++k) {
      // Without a tolerance equal points share a cell by their bits; adding zero makes -0 and +0 the same.
      const double x = p[k] + 0.0;
      cell[static_cast<std::size_t>(k)] =
          tolerance_ > 0.0 ? static_cast<std::int64_t>(std::floor(x / tolerance_)) : std::bit_cast<std::int64_t>(x);
    }
    return cell;
  }

  double tolerance_;
  std::unordered_multimap<Cell, Kept, CellHash> points_;
};

/// The same face whatever corner it starts from; the sense of rotation stays.
Triangle smallest_first(const Triangle& t) {
  const auto k = static_cast<std::size_t>(std::min_element(t.begin(), t.end()) - t.begin());
  return {t[k], t[(k + 1) % 3], t[(k + 2) % 3]};
}

}  // namespace

double compute_volume(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return 0.0;
  // Measured from a vertex of the mesh, or a small body far from the origin would drown in cancellation.
  const Vec3 origin = mesh.vertices[mesh.triangles[0][0]];
  double six_volumes = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - origin, b = mesh.vertices[t[1]] - origin, c = mesh.vertices[t[2]] - origin;
    six_volumes += a.dot(b.cross(c));
  }
  return six_volumes / 6.0;
}

double compute_area(const TriangleMesh& mesh) {
  double two_areas = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]];
    two_areas += (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm();
  }
  return 0.5 * two_areas;
}

Box3 compute_bounds(const TriangleMesh& mesh) {
  Box3 box;
  for (const Vec3& v : mesh.vertices) box.extend(v);
  return box;
}

MeshTopology compute_topology(const TriangleMesh& mesh) {
  MeshTopology topology;
  const std::vector<HalfEdge> edges = collect_half_edges(mesh);

  // Edges, by the number and the directions of the faces on them.
  std::int64_t n_edges = 0;
  for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
    std::int64_t n_ascending = 0;
    while (last < edges.size() && edges[last].low == edges[first].low && edges[last].high == edges[first].high)
      n_ascending += edges[last++].ascending ? 1 : 0;
    const std::size_t n_faces = last - first;
    ++n_edges;
    if (n_faces == 1) ++topology.n_boundary_edges;
    if (n_faces == 2 && n_ascending != 1) ++topology.n_misoriented_edges;
    if (n_faces > 2) ++topology.n_nonmanifold_edges;
  }

  // Components and vertices in use.
  Components components(mesh.vertices.size());
  std::vector<char> used(mesh.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    if (is_degenerate(t)) ++topology.n_degenerate_faces;
    for (const std::uint32_t v : t) used[v] = 1;
    components.join(t[0], t[1]);
    components.join(t[1], t[2]);
  }
  std::int64_t n_used = 0;
  for (std::uint32_t v = 0; v < used.size(); ++v) {
    n_used += used[v];
    if (used[v] && components.find(v) == v) ++topology.n_components;
  }
  const auto n_faces = static_cast<std::int64_t>(mesh.triangles.size() - topology.n_degenerate_faces);
  topology.euler_characteristic = n_used - n_edges + n_faces;
  return topology;
}

TriangleMesh weld(const TriangleMesh& mesh, double tolerance) {
  CHECK_GE(tolerance, 0.0);
  // Each vertex goes to the earliest one kept near it.
  PointGrid grid(tolerance);
  std::vector<std::uint32_t> kept_of(mesh.vertices.size());
  for (std::uint32_t v = 0; v < kept_of.size(); ++v) kept_of[v] = grid.find_or_keep(mesh.vertices[v], v);

  // Faces that still have three corners, each once.
  TriangleMesh welded;
  std::set<Triangle> seen;
  std::vector<char> used(mesh.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    const Triangle face = {kept_of[t[0]], kept_of[t[1]], kept_of[t[2]]};
    if (is_degenerate(face) || !seen.insert(smallest_first(face)).second) continue;
    welded.triangles.push_back(face);
    for (const std::uint32_t v : face) used[v] = 1;
  }

  // Vertices in use, renumbered in their old order.
  std::vector<std::uint32_t> new_index(mesh.vertices.size(), 0);
  for (std::uint32_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    new_index[v] = static_cast<std::uint32_t>(welded.vertices.size());
    welded.vertices.push_back(mesh.vertices[v]);
  }
  for (Triangle& t : welded.triangles)
    for (std::uint32_t& v : t) v = new_index[v];
  return welded;
}

}  // namespace smelt
