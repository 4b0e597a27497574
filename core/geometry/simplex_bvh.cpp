#include "core/geometry/simplex_bvh.h"

#include "core/geometry/facet.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace smelt {

namespace {

/// Lanes compute without branches, and so without infinities, which breed NaN.
constexpr float nowhere = 1e18f;   ///< where the boxes of empty lanes are [m]
constexpr float slowest = 1e-18f;  ///< added to ways, so that none is zero [m]
constexpr float visited = std::numeric_limits<float>::infinity();

}  // namespace

/// Halves ranges of simplices across their longest axis, down to eight parts a node.
template <int Dim>
struct SimplexBvh<Dim>::Builder {
  SimplexBvh& bvh;
  std::vector<Box<Dim>> boxes;  ///< of the simplices
  std::vector<std::uint32_t> order;

  explicit Builder(SimplexBvh& built) : bvh(built), boxes(built.simplices_.size()), order(boxes.size()) {
    std::iota(order.begin(), order.end(), 0u);
    for (std::size_t k = 0; k < boxes.size(); ++k)
      for (const Vec<Dim>& corner : bvh.simplices_[k]) boxes[k].extend(corner);
  }

  Box<Dim> bounds(std::uint32_t begin, std::uint32_t end) const {
    Box<Dim> all;
    for (std::uint32_t k = begin; k < end; ++k) {
      all.extend(boxes[order[k]].lower);
      all.extend(boxes[order[k]].upper);
    }
    return all;
  }

  /// Sorts [begin, end) of the order into `n_parts` parts of like size and appends their ends.
  void split(std::uint32_t begin, std::uint32_t end, std::uint32_t n_parts, std::vector<std::uint32_t>& ends) {
    if (n_parts == 1) return ends.push_back(end);
    Box<Dim> centres;
    for (std::uint32_t k = begin; k < end; ++k) centres.extend(boxes[order[k]].centre());
    int axis = 0;
    centres.extent().maxCoeff(&axis);
    const std::uint32_t n_left = n_parts / 2;
    const auto middle = begin + static_cast<std::uint32_t>(std::uint64_t{end - begin} * n_left / n_parts);
    // Ties go by index, so that the tree depends on the simplices alone.
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
      const double at_a = boxes[a].lower[axis] + boxes[a].upper[axis],
                   at_b = boxes[b].lower[axis] + boxes[b].upper[axis];
      return at_a != at_b ? at_a < at_b : a < b;
    };
    std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end, before);
    split(begin, middle, n_left, ends);
    split(middle, end, n_parts - n_left, ends);
  }

  Leaf make_leaf(std::uint32_t begin, std::uint32_t end) const {
    Leaf leaf;
    leaf.simplex.fill(none);
    leaf.normal.fill(Lanes::Zero());
    leaf.lower = leaf.upper = Lanes::Zero();
    for (std::uint32_t lane = 0; lane < end - begin; ++lane) {
      const Simplex<Dim>& simplex = bvh.simplices_[order[begin + lane]];
      const Vec<Dim> normal = facet_normal<Dim>(simplex);
      Box<1> heights;
      for (const Vec<Dim>& corner : simplex) heights.extend(Vec<1>(normal.dot(corner - bvh.middle_)));
      leaf.simplex[lane] = order[begin + lane];
      for (int axis = 0; axis < Dim; ++axis) leaf.normal[axis][lane] = static_cast<float>(normal[axis]);
      leaf.lower[lane] = static_cast<float>(heights.lower[0]);
      leaf.upper[lane] = static_cast<float>(heights.upper[0]);
    }
    return leaf;
  }

  /// Fills a node, and those below it, with [begin, end) of the order. As few parts as can be, so that leaves are full.
  void build(std::uint32_t node, std::uint32_t begin, std::uint32_t end) {
    std::uint64_t n_below = 1;
    while (n_below * width < end - begin) n_below *= width;
    std::vector<std::uint32_t> ends;
    split(begin, end, static_cast<std::uint32_t>((end - begin + n_below - 1) / n_below), ends);
    Node filled;
    filled.leaf = n_below == 1;
    filled.first = static_cast<std::uint32_t>(filled.leaf ? bvh.leaves_.size() : bvh.nodes_.size());
    for (int axis = 0; axis < Dim; ++axis) {
      filled.lower[axis].setConstant(nowhere);
      filled.upper[axis].setConstant(nowhere);
    }
    for (std::uint32_t lane = 0; lane < ends.size(); ++lane) {
      const Box<Dim> box = bounds(lane == 0 ? begin : ends[lane - 1], ends[lane]);
      for (int axis = 0; axis < Dim; ++axis) {
        filled.lower[axis][lane] = static_cast<float>(box.lower[axis] - bvh.middle_[axis]);
        filled.upper[axis][lane] = static_cast<float>(box.upper[axis] - bvh.middle_[axis]);
      }
    }
    bvh.nodes_[node] = filled;
    if (filled.leaf) return bvh.leaves_.push_back(make_leaf(begin, end));
    bvh.nodes_.resize(bvh.nodes_.size() + ends.size());
    for (std::uint32_t lane = 0; lane < ends.size(); ++lane)
      build(filled.first + lane, lane == 0 ? begin : ends[lane - 1], ends[lane]);
  }
};

template <int Dim>
SimplexBvh<Dim>::SimplexBvh(std::vector<Simplex<Dim>> simplices) : simplices_(std::move(simplices)) {
  if (simplices_.empty()) return;
  Builder builder(*this);
  const auto n = static_cast<std::uint32_t>(simplices_.size());
  const Box<Dim> bounds = builder.bounds(0, n);
  middle_ = bounds.centre();
  extent_ = bounds.extent().maxCoeff();
  nodes_.resize(1);
  builder.build(0, 0, n);
}

/// What is nearer to a point than a limit.
template <int Dim>
struct SimplexBvh<Dim>::BallQuery {
  Vecf<Dim> point;
  double rounding;
  float limit = 0.0f;  ///< squared [m^2]

  BallQuery(const SimplexBvh& bvh, const Vec<Dim>& at, double radius)
      : point((at - bvh.middle_).template cast<float>()), rounding(2e-6 * (bvh.extent_ + (at - bvh.middle_).norm())) {
    set_radius(radius);
  }

  void set_radius(double radius) {
    const float reach = std::min(static_cast<float>(1.00001 * radius + rounding), 0.1f * nowhere);
    limit = reach * reach;
  }

  /// Of each lane, at most its squared distance.
  Lanes entry(const Node& node, const Leaf* leaf) const {
    Lanes distance2 = Lanes::Zero();
    for (int axis = 0; axis < Dim; ++axis)
      distance2 += (node.lower[axis] - point[axis]).max(point[axis] - node.upper[axis]).max(0.0f).square();
    if (!leaf) return distance2;
    Lanes height = Lanes::Zero();
    for (int axis = 0; axis < Dim; ++axis) height += leaf->normal[axis] * point[axis];
    return distance2.max((leaf->lower - height).max(height - leaf->upper).max(0.0f).square());
  }
};

/// What a moving sphere meets earlier than a limit.
template <int Dim>
struct SimplexBvh<Dim>::SweepQuery {
  Vecf<Dim> ahead, behind, way, inverse;  ///< the start plus and less `half`; the way and one over it, axis by axis
  float half;                             ///< a side of a cube that holds the sphere [m]
  float limit = 1.0f;                     ///< share of the way

  SweepQuery(const SimplexBvh& bvh, const Vec<Dim>& centre, const Vec<Dim>& displacement, double radius) {
    const Vec<Dim> start = centre - bvh.middle_;
    half = static_cast<float>(radius + 2e-6 * (bvh.extent_ + start.norm() + displacement.norm() + radius));
    ahead = start.template cast<float>().array() + half;
    behind = start.template cast<float>().array() - half;
    way = displacement.template cast<float>().array() + slowest;
    inverse = way.cwiseInverse();
  }

  /// Of each lane, at most the share of the way at which the sphere touches it; before 0 where it does so at the start.
  Lanes entry(const Node& node, const Leaf* leaf) const {
    Lanes enter = Lanes::Constant(-nowhere), leave = Lanes::Constant(nowhere);
    const auto clip = [&](const Lanes& a, const Lanes& b) {
      enter = enter.max(a.min(b));
      leave = leave.min(a.max(b));
    };
    for (int axis = 0; axis < Dim; ++axis)
      clip((node.lower[axis] - ahead[axis]) * inverse[axis], (node.upper[axis] - behind[axis]) * inverse[axis]);
    if (leaf) {
      Lanes height = Lanes::Zero(), rise = Lanes::Constant(slowest);
      for (int axis = 0; axis < Dim; ++axis) {
        height += leaf->normal[axis] * (ahead[axis] - half);
        rise += leaf->normal[axis] * way[axis];
      }
      const Lanes inverse_rise = rise.inverse();
      clip((leaf->lower - height - half) * inverse_rise, (leaf->upper - height + half) * inverse_rise);
    }
    // What leaves before it enters is missed.
    return enter.max((enter.max(0.0f) - leave) * nowhere);
  }
};

/// Calls meet(simplex) for what a query reaches within its limit, which meet() may lower: the nearest first.
template <int Dim>
template <typename Query, typename Meet>
void SimplexBvh<Dim>::visit(std::uint32_t node, Query& query, const Meet& meet) const {
  const Node& boxes = nodes_[node];
  const Leaf* leaf = boxes.leaf ? &leaves_[boxes.first] : nullptr;
  Lanes entry = query.entry(boxes, leaf);
  for (float nearest = entry.minCoeff(); nearest < query.limit; nearest = entry.minCoeff()) {
    std::uint32_t lane = 0;
    while (entry[lane] != nearest) ++lane;
    entry[lane] = visited;
    if (leaf)
      meet(leaf->simplex[lane]);
    else
      visit(boxes.first + lane, query, meet);
  }
}

template <int Dim>
void SimplexBvh<Dim>::find_near(const Vec<Dim>& point, double radius, std::vector<std::uint32_t>& found) const {
  if (nodes_.empty()) return;
  const auto before = static_cast<std::ptrdiff_t>(found.size());
  BallQuery query(*this, point, radius);
  visit(0, query, [&](std::uint32_t k) {
    if ((point - closest_point<Dim>(point, simplices_[k])).norm() <= radius) found.push_back(k);
  });
  std::sort(found.begin() + before, found.end());
}

template <int Dim>
std::optional<NearestSimplex<Dim>> SimplexBvh<Dim>::nearest(const Vec<Dim>& point, double limit) const {
  if (nodes_.empty()) return std::nullopt;
  NearestSimplex<Dim> nearest{none, limit, Vec<Dim>::Zero()};
  BallQuery query(*this, point, limit);
  visit(0, query, [&](std::uint32_t k) {
    const Vec<Dim> offset = point - closest_point<Dim>(point, simplices_[k]);
    const double distance = offset.norm();
    if (!(distance < nearest.distance) &&
        !(distance == nearest.distance && k < nearest.simplex && nearest.simplex != none))
      return;
    nearest = {k, distance, offset};
    query.set_radius(distance);
  });
  if (nearest.simplex == none) return std::nullopt;
  return nearest;
}

template <int Dim>
double SimplexBvh<Dim>::distance(const Vec<Dim>& point, double limit) const {
  const auto found = nearest(point, limit);
  return found ? found->distance : limit;
}

/// Replaces `first` by the contact with simplex `k` where that comes before it.
template <int Dim>
template <typename Query>
void SimplexBvh<Dim>::improve(std::optional<FirstContact<Dim>>& first, std::uint32_t k, Query& query,
                              const Vec<Dim>& centre, const Vec<Dim>& displacement, double radius) const {
  const auto contact =
      sweep_sphere<Dim>(centre, displacement, radius, simplices_[k], first ? first->contact.time : 1.0);
  if (!contact) return;
  if (first && !(contact->time < first->contact.time) && !(contact->time == first->contact.time && k < first->simplex))
    return;
  first = {k, *contact};
  query.limit = static_cast<float>(contact->time);
}

template <int Dim>
std::optional<FirstContact<Dim>> SimplexBvh<Dim>::first_contact(const Vec<Dim>& centre, const Vec<Dim>& displacement,
                                                                double radius, std::uint32_t except) const {
  std::optional<FirstContact<Dim>> first;
  if (nodes_.empty() || displacement.isZero(0.0)) return first;
  SweepQuery query(*this, centre, displacement, radius);
  visit(0, query, [&](std::uint32_t k) {
    if (k != except) improve(first, k, query, centre, displacement, radius);
  });
  return first;
}

template <int Dim>
std::size_t SimplexBvh<Dim>::count_visits(const Vec<Dim>& centre, const Vec<Dim>& displacement, double radius) const {
  struct CountingQuery : SweepQuery {
    using SweepQuery::SweepQuery;
    mutable std::size_t n_nodes = 0;
    Lanes entry(const Node& node, const Leaf* leaf) const {
      ++n_nodes;
      return SweepQuery::entry(node, leaf);
    }
  };
  if (nodes_.empty() || displacement.isZero(0.0)) return 0;
  std::optional<FirstContact<Dim>> first;
  CountingQuery query(*this, centre, displacement, radius);
  visit(0, query, [&](std::uint32_t k) { improve(first, k, query, centre, displacement, radius); });
  return query.n_nodes;
}

template class SimplexBvh<1>;
template class SimplexBvh<2>;
template class SimplexBvh<3>;

}  // namespace smelt
