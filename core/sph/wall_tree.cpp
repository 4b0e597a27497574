#include "core/sph/wall_tree.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace smelt {

namespace {

constexpr std::uint32_t leaf_size = 4;
constexpr double flat_cosine = 0.985;  ///< some ten degrees, as contacts are told apart by
constexpr int max_depth = 3;           ///< a facet is cut into 64 samples at most
constexpr int no_patch = -1;

WallSample whole_facet(const Simplex<3>& t) {
  WallSample sample{(t[0] + t[1] + t[2]) / 3.0, 0.5 * (t[1] - t[0]).cross(t[2] - t[0]), Mat3::Zero()};
  for (const Vec3& corner : t) sample.spread += (corner - sample.centre) * (corner - sample.centre).transpose() / 12.0;
  return sample;
}

double circumscribed_radius(const Simplex<3>& t, const Vec3& centre) {
  double radius2 = 0.0;
  for (const Vec3& corner : t) radius2 = std::max(radius2, (corner - centre).squaredNorm());
  return std::sqrt(radius2);
}

}  // namespace

struct WallTree::Query {
  Vec3 point;
  double h, reach, slack;
  WallPatches& patches;
  std::vector<std::uint32_t>& facets;

  /// Largest radius of a piece whose nearest point is `distance` away.
  double largest(double distance) const { return std::min(0.4 * h, 0.35 * (distance - 0.5 * slack)); }

  /// The patch that a piece belongs to; a new one where there is none.
  int patch_of(const Vec3& centre, const Vec3& area) {
    const double length = area.norm(), plane = (point - centre).dot(area) / length;
    for (std::size_t k = 0; k < patches.n; ++k) {
      const WallPatch& p = patches.patch[k];
      if (p.area.dot(area) > flat_cosine * p.area.norm() * length && (plane > 0.0) == (p.plane > 0.0) &&
          std::abs(plane - p.plane) < 0.25 * h)
        return static_cast<int>(k);
    }
    if (patches.n == patches.patch.size()) patches.patch.emplace_back();
    WallPatch& p = patches.patch[patches.n];
    p.area = area;
    p.plane = plane;
    p.samples.clear();
    return static_cast<int>(patches.n++);
  }

  void add(int patch, const WallSample& sample) {
    if (patch == no_patch) patch = patch_of(sample.centre, sample.area);
    patches.patch[static_cast<std::size_t>(patch)].samples.push_back(sample);
  }

  /// Cuts a triangle into four until its pieces are small enough.
  void cut(const Simplex<3>& t, double radius, const WallSample& whole, int depth, int patch) {
    const double distance = (point - whole.centre).norm() - radius;
    if (distance > reach + slack) return;
    if (depth == 0 || radius <= largest(distance)) return add(patch, whole);
    const Vec3 ab = 0.5 * (t[0] + t[1]), bc = 0.5 * (t[1] + t[2]), ca = 0.5 * (t[2] + t[0]);
    for (const Simplex<3>& piece : {Simplex<3>{t[0], ab, ca}, {t[1], bc, ab}, {t[2], ca, bc}, {ab, bc, ca}})
      cut(piece, 0.5 * radius, {(piece[0] + piece[1] + piece[2]) / 3.0, 0.25 * whole.area, 0.25 * whole.spread},
          depth - 1, patch);
  }
};

WallTree::WallTree(std::span<const Simplex<3>> facets) : facets_(facets), order_(facets.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  for (const Simplex<3>& t : facets) {
    const WallSample sample = whole_facet(t);
    leaves_.push_back({sample, circumscribed_radius(t, sample.centre)});
  }
  if (facets.empty()) return;
  nodes_.reserve(facets.size());
  nodes_.push_back({});
  nodes_[0].end = static_cast<std::uint32_t>(facets.size());
  build(0);
  std::vector<Leaf> sorted;
  sorted.reserve(facets.size());
  for (const std::uint32_t f : order_) sorted.push_back(leaves_[f]);
  leaves_.swap(sorted);
}

void WallTree::build(std::uint32_t node) {
  Node n = nodes_[node];
  Box3 box;
  double total = 0.0;
  for (std::uint32_t k = n.begin; k < n.end; ++k) {
    const WallSample& sample = leaves_[order_[k]].sample;
    n.area += sample.area;
    n.centre += sample.area.norm() * sample.centre;
    total += sample.area.norm();
    box.extend(sample.centre);
  }
  n.centre = total > 0.0 ? Vec3(n.centre / total) : box.centre();
  n.flat = n.area.norm() > flat_cosine * total;
  for (std::uint32_t k = n.begin; k < n.end && total > 0.0; ++k) {
    const WallSample& sample = leaves_[order_[k]].sample;
    const Vec3 off = sample.centre - n.centre;
    n.spread += sample.area.norm() / total * (sample.spread + off * off.transpose());
  }
  for (std::uint32_t k = n.begin; k < n.end; ++k)
    n.radius = std::max(n.radius, circumscribed_radius(facets_[order_[k]], n.centre));
  if (n.end - n.begin <= leaf_size) {
    nodes_[node] = n;
    return;
  }
  // Halved across its longest axis. Ties go by index, so that the tree depends on the facets alone.
  int axis = 0;
  box.extent().maxCoeff(&axis);
  const std::uint32_t middle = (n.begin + n.end) / 2;
  std::nth_element(order_.begin() + n.begin, order_.begin() + middle, order_.begin() + n.end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     return leaves_[a].sample.centre[axis] != leaves_[b].sample.centre[axis]
                                ? leaves_[a].sample.centre[axis] < leaves_[b].sample.centre[axis]
                                : a < b;
                   });
  n.left = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node] = n;
  Node child;
  child.begin = n.begin;
  child.end = middle;
  nodes_.push_back(child);
  child.begin = middle;
  child.end = n.end;
  nodes_.push_back(child);
  build(n.left);
  build(n.left + 1);
}

void WallTree::visit(std::uint32_t node, int patch, Query& query) const {
  const Node& n = nodes_[node];
  const double distance = (query.point - n.centre).norm() - n.radius;
  if (distance > query.reach + query.slack) return;
  if (n.flat) {
    if (n.radius <= query.largest(distance)) return query.add(patch, {n.centre, n.area, n.spread});
    // All of it is one patch if it is short enough to be level. Ten degrees over a quarter of h stay far below the
    // planes' h/4.
    if (patch == no_patch && n.radius <= query.h) patch = query.patch_of(n.centre, n.area);
  }
  if (n.left == 0) {
    for (std::uint32_t k = n.begin; k < n.end; ++k) visit_facet(k, patch, query);
    return;
  }
  visit(n.left, patch, query);
  visit(n.left + 1, patch, query);
}

void WallTree::visit_facet(std::uint32_t k, int patch, Query& query) const {
  const Leaf& leaf = leaves_[k];
  if (leaf.sample.area.isZero(0.0)) return;
  const double near = (query.point - leaf.sample.centre).norm() - leaf.radius;
  if (near > query.reach + query.slack) return;
  if (leaf.radius <= query.largest(near)) return query.add(patch, leaf.sample);
  const Simplex<3>& t = facets_[order_[k]];
  const double distance = (query.point - closest_point<3>(query.point, t)).norm();
  if (distance > query.reach + query.slack) return;
  // Slivers are not small across what they are long: their pieces stay slivers, and are as good.
  if (leaf.radius > (1 << max_depth) * query.largest(distance))
    query.facets.push_back(order_[k]);
  else
    query.cut(t, leaf.radius, leaf.sample, max_depth, patch);
}

void WallTree::gather(const Vec3& point, double h, double reach, double slack, WallPatches& patches,
                      std::vector<std::uint32_t>& facets) const {
  patches.n = 0;
  if (nodes_.empty()) return;
  Query query{point, h, reach, slack, patches, facets};
  visit(0, no_patch, query);
}

}  // namespace smelt
