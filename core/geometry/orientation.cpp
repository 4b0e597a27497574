#include "core/geometry/orientation.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <utility>

namespace smelt {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Two faces and the edge that they alone share.
struct Meeting {
  std::uint32_t other;
  bool against;  ///< both run through the edge in the same direction
};

/// Of faces with the same corners the first stays.
std::size_t drop_doubles(TriangleMesh& mesh) {
  std::vector<std::pair<Triangle, std::size_t>> by_corners;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    by_corners.emplace_back(mesh.triangles[f], f);
    std::sort(by_corners.back().first.begin(), by_corners.back().first.end());
  }
  std::sort(by_corners.begin(), by_corners.end());
  std::vector<bool> is_double(mesh.triangles.size(), false);
  for (std::size_t k = 1; k < by_corners.size(); ++k)
    is_double[by_corners[k].second] = by_corners[k].first == by_corners[k - 1].first;
  std::size_t n_kept = 0;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    if (!is_double[f]) mesh.triangles[n_kept++] = mesh.triangles[f];
  const std::size_t n_dropped = mesh.triangles.size() - n_kept;
  mesh.triangles.resize(n_kept);
  return n_dropped;
}

std::vector<std::vector<Meeting>> find_meetings(const TriangleMesh& mesh) {
  struct Side {
    std::uint32_t low, high, face;
    bool ascending;
  };
  std::vector<Side> sides;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[f][k], b = mesh.triangles[f][(k + 1) % 3];
      if (a != b) sides.push_back({std::min(a, b), std::max(a, b), f, a < b});
    }
  const auto same_edge = [](const Side& p, const Side& q) { return p.low == q.low && p.high == q.high; };
  std::sort(sides.begin(), sides.end(),
            [](const Side& p, const Side& q) { return p.low != q.low ? p.low < q.low : p.high < q.high; });
  std::vector<std::vector<Meeting>> meetings(mesh.triangles.size());
  for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
    while (last < sides.size() && same_edge(sides[first], sides[last])) ++last;
    if (last - first != 2) continue;
    const Side &p = sides[first], &q = sides[first + 1];
    meetings[p.face].push_back({q.face, p.ascending == q.ascending});
    meetings[q.face].push_back({p.face, p.ascending == q.ascending});
  }
  return meetings;
}

Vec3 vector_area(const TriangleMesh& mesh, const Triangle& t) {
  const Vec3 a = mesh.vertices[t[0]];
  return 0.5 * (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
}

enum class Way : char { unknown, as_it_is, turned };

Way across(Way way, bool against) {
  if (!against) return way;
  return way == Way::as_it_is ? Way::turned : Way::as_it_is;
}

}  // namespace

Orientation orient(TriangleMesh& mesh) {
  Orientation found;
  found.n_dropped = drop_doubles(mesh);
  const auto meetings = find_meetings(mesh);
  std::vector<Way> way(mesh.triangles.size(), Way::unknown);
  for (std::uint32_t seed = 0; seed < mesh.triangles.size(); ++seed) {
    if (way[seed] != Way::unknown) continue;
    std::vector<std::uint32_t> part{seed};
    way[seed] = Way::as_it_is;
    bool orientable = true;
    double area_as_it_is = 0.0, area_turned = 0.0;
    for (std::size_t k = 0; k < part.size(); ++k) {
      const std::uint32_t f = part[k];
      (way[f] == Way::turned ? area_turned : area_as_it_is) += vector_area(mesh, mesh.triangles[f]).norm();
      for (const Meeting& meeting : meetings[f]) {
        const Way wanted = across(way[f], meeting.against);
        if (way[meeting.other] == Way::unknown) {
          way[meeting.other] = wanted;
          part.push_back(meeting.other);
        }
        orientable = orientable && way[meeting.other] == wanted;
      }
    }
    found.orientable = found.orientable && orientable;
    if (!orientable) continue;
    const Way to_turn = area_turned > area_as_it_is ? Way::as_it_is : Way::turned;
    for (const std::uint32_t f : part) {
      if (way[f] != to_turn) continue;
      std::swap(mesh.triangles[f][1], mesh.triangles[f][2]);
      ++found.n_turned;
    }
  }
  return found;
}

Vec3 compute_vector_area(const TriangleMesh& mesh) {
  Vec3 area = Vec3::Zero();
  for (const Triangle& t : mesh.triangles) area += vector_area(mesh, t);
  return area;
}

}  // namespace smelt
