#include "core/geometry/inside.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>

namespace smelt {
namespace {

using Exact = CGAL::Exact_predicates_inexact_constructions_kernel;

/// On which side of the edge a -> b, seen along x, the point q = (y, z) lies: +1 left, -1 right, 0 where the edge
/// itself is seen as a point. A q on the edge counts as shifted by an infinitesimal step in y and a smaller one in z,
/// so that a line through an edge or a vertex crosses exactly one of the faces there.
int side_of_edge(const Vec3& a, const Vec3& b, const Exact::Point_2& q) {
  const CGAL::Orientation side = CGAL::orientation(Exact::Point_2(a.y(), a.z()), Exact::Point_2(b.y(), b.z()), q);
  if (side != CGAL::COLLINEAR) return side == CGAL::LEFT_TURN ? 1 : -1;
  if (a.z() != b.z()) return a.z() > b.z() ? 1 : -1;
  if (a.y() != b.y()) return b.y() > a.y() ? 1 : -1;
  return 0;
}

double x_on_plane(const Vec3& a, const Vec3& b, const Vec3& c, double y, double z) {
  const Vec3 u = b - a, v = c - a;
  const double dy = y - a.y(), dz = z - a.z();
  const double area = u.y() * v.z() - u.z() * v.y();
  const double s = (dy * v.z() - dz * v.y()) / area, t = (u.y() * dz - u.z() * dy) / area;
  // A face seen edge-on has almost no area; the crossing still is between its corners.
  const auto [low, high] = std::minmax({a.x(), b.x(), c.x()});
  return std::min(std::max(a.x() + s * u.x() + t * v.x(), low), high);
}

}  // namespace

InsideTest::InsideTest(const TriangleMesh& mesh, double line_spacing) : mesh_(mesh), bounds_(compute_bounds(mesh)) {
  if (mesh.triangles.empty()) return;
  // As many bins as lines are enough; more than faces would be waste.
  const double extent = std::max(bounds_.extent().y(), bounds_.extent().z());
  bin_width_ = std::max(line_spacing, extent / std::sqrt(static_cast<double>(mesh.triangles.size())));
  n_y_ = bin_y(bounds_.upper.y()) + 1;
  n_z_ = bin_z(bounds_.upper.z()) + 1;
  faces_in_bin_.resize(n_y_ * n_z_);
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    Box3 box;
    for (const std::uint32_t v : mesh.triangles[f]) box.extend(mesh.vertices[v]);
    for (std::size_t z = bin_z(box.lower.z()); z <= bin_z(box.upper.z()); ++z)
      for (std::size_t y = bin_y(box.lower.y()); y <= bin_y(box.upper.y()); ++y)
        faces_in_bin_[z * n_y_ + y].push_back(f);
  }
}

void InsideTest::intersect(double y, double z, std::vector<Crossing>& crossings) const {
  crossings.clear();
  if (faces_in_bin_.empty() || y < bounds_.lower.y() || y > bounds_.upper.y() || z < bounds_.lower.z() ||
      z > bounds_.upper.z())
    return;
  const Exact::Point_2 q(y, z);
  for (const std::uint32_t f : faces_in_bin_[bin_z(z) * n_y_ + bin_y(y)]) {
    const Vec3& a = mesh_.vertices[mesh_.triangles[f][0]];
    const Vec3& b = mesh_.vertices[mesh_.triangles[f][1]];
    const Vec3& c = mesh_.vertices[mesh_.triangles[f][2]];
    const int side = side_of_edge(a, b, q);
    if (side == 0 || side_of_edge(b, c, q) != side || side_of_edge(c, a, q) != side) continue;
    // A face that is counter-clockwise seen from +x looks to +x: the line leaves the body there.
    crossings.push_back({x_on_plane(a, b, c, y, z), -side});
  }
  std::sort(crossings.begin(), crossings.end(),
            [](const Crossing& p, const Crossing& r) { return p.x != r.x ? p.x < r.x : p.winding > r.winding; });
}

bool InsideTest::contains(const Vec3& p, std::vector<Crossing>& crossings) const {
  intersect(p.y(), p.z(), crossings);
  int winding = 0;
  for (const Crossing& c : crossings)
    if (c.x < p.x()) winding += c.winding;
  return winding != 0;
}

}  // namespace smelt
