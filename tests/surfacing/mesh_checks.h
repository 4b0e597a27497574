#pragma once
// What the surfacing tests ask of a mesh.

#include "core/geometry/triangle_mesh.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace smelt::testing {

/// Everything that can be wrong with the connectivity of a closed oriented mesh: an edge without exactly two faces that
/// run through it in opposite directions, a face that occurs twice (in either sense), an unused vertex, two vertices at
/// one place. Empty when nothing is.
inline std::string find_defect(const TriangleMesh& mesh) {
  struct Out {
    std::uint32_t to, third;  // an edge out of a vertex, and the face on its left
  };
  const std::size_t n = mesh.vertices.size();
  std::vector<std::uint32_t> begin(n + 1, 0);
  for (const auto& t : mesh.triangles)
    for (const auto v : t) ++begin[v + 1];
  for (std::size_t v = 0; v < n; ++v) {
    if (begin[v + 1] == 0) return fmt::format("vertex {} is not used", v);
    begin[v + 1] += begin[v];
  }
  std::vector<Out> out(3 * mesh.triangles.size());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (const auto& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) out[next[t[i]]++] = {t[(i + 1) % 3], t[(i + 2) % 3]};

  for (std::uint32_t v = 0; v < n; ++v)
    for (std::uint32_t e = begin[v]; e < begin[v + 1]; ++e) {
      if (out[e].to == v) return fmt::format("degenerate face at {}", v);
      for (std::uint32_t other = begin[v]; other < e; ++other)
        if (out[other].to == out[e].to) return fmt::format("two faces run from {} to {}", v, out[e].to);
      bool returns = false;
      for (std::uint32_t back = begin[out[e].to]; back < begin[out[e].to + 1]; ++back) {
        if (out[back].to != v) continue;
        returns = true;
        if (out[back].third == out[e].third) return fmt::format("face {} {} {} twice", v, out[e].to, out[e].third);
      }
      if (!returns) return fmt::format("open edge from {} to {}", v, out[e].to);
    }

  std::vector<std::array<double, 3>> places;
  places.reserve(n);
  for (const Vec3& x : mesh.vertices) places.push_back({x[0], x[1], x[2]});
  std::sort(places.begin(), places.end());
  if (std::adjacent_find(places.begin(), places.end()) != places.end()) return "two vertices at one place";
  return "";
}

/// A closed piece that winds the wrong way: outer surfaces have positive volume, cavities negative, and a piece inside
/// an odd number of others is a cavity. Counts crossings of a ray along x from a vertex of each piece through the
/// others.
inline std::string find_inverted_piece(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> piece(mesh.vertices.size());
  for (std::uint32_t v = 0; v < piece.size(); ++v) piece[v] = v;
  const auto root = [&](std::uint32_t v) {
    while (piece[v] != v) v = piece[v] = piece[piece[v]];
    return v;
  };
  for (const auto& t : mesh.triangles)
    for (int i = 1; i < 3; ++i) piece[root(t[0])] = root(t[i]);
  for (std::uint32_t v = 0; v < piece.size(); ++v) {
    if (root(v) != v) continue;
    double volume = 0.0;
    int n_crossed = 0;
    // Off the lattice, so that the ray meets no edge.
    const Vec3 from = mesh.vertices[v] + Vec3(0.0, 1.7e-7, 2.3e-7);
    for (const auto& t : mesh.triangles) {
      const Vec3 a = mesh.vertices[t[0]] - from, b = mesh.vertices[t[1]] - from, c = mesh.vertices[t[2]] - from;
      if (root(t[0]) == v) {
        volume += a.dot(b.cross(c)) / 6.0;
        continue;
      }
      const auto side = [](const Vec3& p, const Vec3& q) { return p[1] * q[2] - p[2] * q[1]; };
      const double ab = side(a, b), bc = side(b, c), ca = side(c, a);
      if ((ab > 0.0) != (bc > 0.0) || (bc > 0.0) != (ca > 0.0)) continue;
      n_crossed += (bc * a[0] + ca * b[0] + ab * c[0]) / (ab + bc + ca) > 0.0;
    }
    if ((volume > 0.0) != (n_crossed % 2 == 0)) return fmt::format("the piece of vertex {} is inside out", v);
  }
  return "";
}

inline double smallest_area(const TriangleMesh& mesh) {
  double smallest = 1e300;
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    smallest = std::min(smallest, 0.5 * (b - a).cross(c - a).norm());
  }
  return smallest;
}

}  // namespace smelt::testing
