#include "core/geometry/thin_parts.h"

#include "core/geometry/simplex_bvh.h"

#include <Eigen/Geometry>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace smelt {
namespace {

// Lengths in spacings of the lattice.
constexpr double bare_distance = 1.2;       // from the surface to the nearest seed
constexpr double least_distance = 0.85;     // between seeds
constexpr double farthest_neighbour = 2.4;  // how far distances between seeds are told apart
constexpr double sampling_distance = 0.5;

/// A point of the surface that no site is near, and the unit vector from there into the body.
struct BarePoint {
  Vec3 position, inward;
};

/// A bare point over a thin part, and the middle of that part beneath it.
struct ThinPlace {
  Vec3 surface, middle;
  double distance;  ///< from the middle to the nearest site [m]
};

/// Calls visit(x) at the centroids of the pieces of a triangle halved until no edge is longer than `longest`. Pieces
/// that can_skip(centroid, radius about it) are left out whole.
template <typename CanSkip, typename Visit>
void visit_pieces(const Simplex<3>& triangle, double longest, const CanSkip& can_skip, const Visit& visit) {
  const Vec3 centroid = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
  double radius = 0.0, length = 0.0;
  std::size_t k = 0;
  for (std::size_t e = 0; e < 3; ++e) {
    radius = std::max(radius, (triangle[e] - centroid).norm());
    if (const double l = (triangle[(e + 1) % 3] - triangle[e]).norm(); l > length) {
      length = l;
      k = e;
    }
  }
  if (can_skip(centroid, radius)) return;
  if (length <= longest) return visit(centroid);
  const Vec3 &a = triangle[k], &b = triangle[(k + 1) % 3], &c = triangle[(k + 2) % 3], middle = 0.5 * (a + b);
  visit_pieces({a, middle, c}, longest, can_skip, visit);
  visit_pieces({middle, b, c}, longest, can_skip, visit);
}

/// Calls append(i, list) for i in [0, n) on many threads and joins the lists in the order of i.
template <typename Value, typename Append>
std::vector<Value> collect(std::size_t n, const Append& append) {
  constexpr std::size_t n_in_block = 64;
  std::vector<std::vector<Value>> of_block((n + n_in_block - 1) / n_in_block);
  tbb::parallel_for(std::size_t{0}, of_block.size(), [&](std::size_t block) {
    for (std::size_t i = block * n_in_block; i < std::min(n, (block + 1) * n_in_block); ++i) append(i, of_block[block]);
  });
  std::vector<Value> all;
  for (const std::vector<Value>& some : of_block) all.insert(all.end(), some.begin(), some.end());
  return all;
}

std::vector<BarePoint> find_bare_points(const std::vector<Simplex<3>>& faces, const LatticeSites& sites) {
  const double spacing = sites.lattice.spacing, limit = bare_distance * spacing;
  return collect<BarePoint>(faces.size(), [&](std::size_t f, std::vector<BarePoint>& found) {
    const Simplex<3>& face = faces[f];
    const Vec3 area = (face[1] - face[0]).cross(face[2] - face[0]);
    if (!(area.squaredNorm() > 0.0)) return;
    const Vec3 inward = -area.normalized();
    visit_pieces(
        face, sampling_distance * spacing,
        [&](const Vec3& x, double radius) { return radius < limit && sites.has_near(x, limit - radius); },
        [&](const Vec3& x) {
          if (!sites.has_near(x, limit)) found.push_back({x, inward});
        });
  });
}

/// How far along the unit vector `direction` the line from `start` leaves the body through `face`, if it does.
std::optional<double> exit_distance(const Vec3& start, const Vec3& direction, const Simplex<3>& face) {
  constexpr double rounding = 1e-9;  // of the barycentric coordinates: a line must not slip out between two faces
  const Vec3 ab = face[1] - face[0], ac = face[2] - face[0], from_a = start - face[0];
  const Vec3 area = ab.cross(ac), moment = from_a.cross(direction);
  const double facing = direction.dot(area);
  if (!(facing > 0.0)) return {};
  const double v = -ac.dot(moment) / facing, w = ab.dot(moment) / facing;
  if (v < -rounding || w < -rounding || v + w > 1.0 + rounding) return {};
  return -from_a.dot(area) / facing;
}

/// How thick the body is beneath a point of its surface; `limit` where it is thicker.
double thickness(const BarePoint& point, const SimplexBvh<3>& walls, double limit, std::vector<std::uint32_t>& near) {
  near.clear();
  walls.find_near(point.position + 0.5 * limit * point.inward, 0.5 * limit, near);
  double nearest = limit;
  for (const std::uint32_t f : near)
    if (const auto d = exit_distance(point.position, point.inward, walls.simplices()[f]); d && *d > 0.0)
      nearest = std::min(nearest, *d);
  return nearest;
}

std::vector<ThinPlace> find_thin_places(const std::vector<BarePoint>& points, const SimplexBvh<3>& walls,
                                        const InsideTest& inside, const LatticeSites& sites) {
  const double spacing = sites.lattice.spacing;
  return collect<ThinPlace>(points.size(), [&](std::size_t i, std::vector<ThinPlace>& found) {
    std::vector<std::uint32_t> near;
    std::vector<Crossing> crossings;
    const double d = thickness(points[i], walls, spacing, near);
    const Vec3 middle = points[i].position + 0.5 * d * points[i].inward;
    if (d < spacing && inside.contains(middle, crossings))
      found.push_back({points[i].position, middle, sites.distance(middle, farthest_neighbour * spacing)});
  });
}

/// Thin places that are still free, sorted by how far they are from the nearest seed so far.
class FreePlaces {
 public:
  FreePlaces(std::vector<ThinPlace> places, double spacing) : places_(std::move(places)), spacing_(spacing) {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      in_cell_[cell_of(places_[i].middle)].push_back(i);
      if (places_[i].distance >= least_distance * spacing_) by_distance_.insert({places_[i].distance, i});
    }
  }

  bool empty() const { return by_distance_.empty(); }

  /// The place nearest to the seeds becomes one: it and those about it are free no longer, others have it nearer than
  /// what they had.
  Vec3 take_nearest() {
    const Vec3 seed = places_[by_distance_.begin()->second].middle;
    const Cell cell = cell_of(seed);
    for (int n = 0; n < 27; ++n)
      if (const auto found = in_cell_.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
          found != in_cell_.end())
        for (const std::size_t i : found->second) approach(i, seed);
    return seed;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cell_of(const Vec3& x) const {
    Cell cell;
    for (int a = 0; a < 3; ++a)
      cell[static_cast<std::size_t>(a)] = static_cast<std::int64_t>(std::floor(x[a] / (farthest_neighbour * spacing_)));
    return cell;
  }

  void approach(std::size_t i, const Vec3& seed) {
    ThinPlace& place = places_[i];
    if (by_distance_.erase({place.distance, i}) == 0) return;
    place.distance = std::min(place.distance, (seed - place.middle).norm());
    if (place.distance >= least_distance * spacing_ && (seed - place.surface).norm() >= bare_distance * spacing_)
      by_distance_.insert({place.distance, i});
  }

  std::vector<ThinPlace> places_;
  double spacing_;
  std::set<std::pair<double, std::size_t>> by_distance_;
  std::map<Cell, std::vector<std::size_t>> in_cell_;
};

}  // namespace

std::vector<Vec3> fill_thin_parts(const TriangleMesh& mesh, const InsideTest& inside, const LatticeSites& sites) {
  const double spacing = sites.lattice.spacing;
  std::vector<Simplex<3>> faces;
  for (const auto& [a, b, c] : mesh.triangles) faces.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
  const std::vector<BarePoint> bare = find_bare_points(faces, sites);
  if (bare.empty()) return {};
  FreePlaces places(find_thin_places(bare, SimplexBvh<3>(std::move(faces)), inside, sites), spacing);
  std::vector<Vec3> seeds;
  while (!places.empty()) seeds.push_back(places.take_nearest());
  return seeds;
}

}  // namespace smelt
