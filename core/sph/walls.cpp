#include "core/sph/walls.h"

#include "core/geometry/facet.h"
#include "core/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace smelt {

namespace {

/// +1 where a particle is in front of an obstacle, -1 behind. A solid's front is outside, whatever the particle sees; a sheet has a
/// front on the side of the particle: that of the nearest facet, of those equally near the one whose plane is farthest.
template <int Dim, typename Candidates>
double side_of(const Obstacle<Dim>& obstacle, const SimplexBvh<Dim>& bvh, const Vec<Dim>& local, const Candidates& candidates) {
  if (obstacle.closed) return 1.0;
  double nearest = std::numeric_limits<double>::infinity();
  double height = 0.0;
  for (const auto& candidate : candidates) {
    const Simplex<Dim>& facet = bvh.simplices()[candidate.facet];
    const double distance = (local - closest_point<Dim>(local, facet)).norm();
    const double plane = (local - facet[0]).dot(facet_normal<Dim>(facet));
    constexpr double tie = 1e-9;
    const bool nearer = distance < (1.0 - tie) * nearest;
    const bool tied = distance <= (1.0 + tie) * nearest;
    if (nearer || (tied && std::abs(plane) > std::abs(height))) height = plane;
    nearest = std::min(nearest, distance);
  }
  return height < 0.0 ? -1.0 : 1.0;
}

/// Whether one point does for a facet: no longer than a quarter of h, and twice as far off.
template <int Dim>
bool is_small(const Simplex<Dim>& facet, const Vec<Dim>& point, double h) {
  if constexpr (Dim == 1) return false;
  const double limit2 = h * h / 16.0;
  for (int k = 0; k < Dim; ++k)
    if ((facet[(k + 1) % Dim] - facet[k]).squaredNorm() > limit2) return false;
  return (facet[0] - point).squaredNorm() > 9.0 * limit2;  // a corner three lengths off: the rest at least two
}

/// The acceleration that fluid at the wall shares. What slips does not go round with the wall: it has no part in the centripetal one.
template <int Dim>
Vec<Dim> wall_acceleration_at(const PlacedObstacle<Dim>& placed, const Vec<Dim>& position) {
  const RigidAcceleration<Dim>& a = placed.acceleration;
  const Vec<Dim> arm = position - a.centre, centripetal = 0.5 * (a.gradient + a.gradient.transpose()) * arm;
  return a.linear + a.gradient * arm - placed.obstacle.response.friction * centripetal;
}

}  // namespace

template <int Dim>
void Walls<Dim>::find(const Colliders<Dim>& colliders, std::span<const Vec<Dim>> position, double slack) {
  struct Found {
    std::vector<std::int32_t> particles;
    std::vector<std::size_t> n_candidates;
    std::vector<Candidate> candidates;
  };
  const double reach = kernel_.support_radius() + slack;
  const std::size_t n_blocks = (position.size() + block_size - 1) / block_size;
  std::vector<Found> blocks(n_blocks);
  parallel_blocks(n_blocks, [&](std::size_t b, std::size_t) {
    Found& block = blocks[b];
    std::vector<std::uint32_t> facets;
    for (std::size_t i = b * block_size; i < std::min(position.size(), (b + 1) * block_size); ++i) {
      const std::size_t before = block.candidates.size();
      for (std::uint32_t o = 0; o < colliders.placed().size(); ++o) {
        const auto& placed = colliders.placed()[o];
        if (!placed.obstacle.wall || placed.gone) continue;
        facets.clear();
        placed.bvh.find_near(placed.begin.to_rest(position[i]), reach, facets);
        for (const std::uint32_t facet : facets) block.candidates.push_back({o, facet});
      }
      if (block.candidates.size() == before) continue;
      block.particles.push_back(static_cast<std::int32_t>(i));
      block.n_candidates.push_back(block.candidates.size() - before);
    }
  }, 1);

  slot_.assign(position.size(), -1);
  neighbours_.clear();
  begin_.assign(1, 0);
  candidates_.clear();
  for (const Found& block : blocks) {
    candidates_.insert(candidates_.end(), block.candidates.begin(), block.candidates.end());
    for (std::size_t k = 0; k < block.particles.size(); ++k) {
      slot_[static_cast<std::size_t>(block.particles[k])] = static_cast<std::int32_t>(neighbours_.size());
      neighbours_.push_back({block.particles[k], 0.0, Mat<Dim>::Zero(), {}});
      begin_.push_back(begin_.back() + block.n_candidates[k]);
    }
  }
}

template <int Dim>
void Walls<Dim>::update(const Colliders<Dim>& colliders, std::span<const Vec<Dim>> position) {
  const std::size_t n_blocks = (neighbours_.size() + block_size - 1) / block_size;
  contacts_.resize(n_blocks);
  parallel_blocks(n_blocks, [&](std::size_t block, std::size_t) {
    std::vector<WallContact<Dim>>& contacts = contacts_[block];
    contacts.clear();
    const std::size_t begin = block * block_size, end = std::min(neighbours_.size(), begin + block_size);
    std::array<std::size_t, block_size + 1> first{};
    for (std::size_t slot = begin; slot < end; ++slot) {
      append_contacts(colliders, position[static_cast<std::size_t>(neighbours_[slot].particle)], slot, contacts);
      first[slot - begin + 1] = contacts.size();
    }
    for (std::size_t slot = begin; slot < end; ++slot)
      neighbours_[slot].contacts = {contacts.data() + first[slot - begin], first[slot - begin + 1] - first[slot - begin]};
  }, 1);
}

template <int Dim>
void Walls<Dim>::append_contacts(const Colliders<Dim>& colliders, const Vec<Dim>& position, std::size_t slot,
                                 std::vector<WallContact<Dim>>& contacts) {
  WallNeighbour<Dim>& seen = neighbours_[slot];
  seen.solid = 0.0;
  seen.moment.setZero();
  const auto own = static_cast<std::ptrdiff_t>(contacts.size());
  const std::span<const Candidate> candidates{candidates_.data() + begin_[slot], begin_[slot + 1] - begin_[slot]};
  for (std::size_t begin = 0, end = 0; begin < candidates.size(); begin = end) {
    const std::uint32_t o = candidates[begin].obstacle;
    while (end < candidates.size() && candidates[end].obstacle == o) ++end;
    const PlacedObstacle<Dim>& placed = colliders.placed()[o];
    const SimplexBvh<Dim>& bvh = placed.bvh;
    const auto of_obstacle = static_cast<std::ptrdiff_t>(contacts.size());
    // Everything at rest first, then turned to where the obstacle is.
    Mat<Dim> moment = Mat<Dim>::Zero();
    const Vec<Dim> local = placed.begin.to_rest(position);
    const double side = side_of<Dim>(placed.obstacle, bvh, local, candidates.subspan(begin, end - begin));
    for (const Candidate& candidate : candidates.subspan(begin, end - begin)) {
      const Simplex<Dim>& facet = bvh.simplices()[candidate.facet];
      const Vec<Dim> normal = side * facet_normal<Dim>(facet);
      const FacetIntegrals<Dim> integrals = is_small<Dim>(facet, local, kernel_.smoothing_length())
                                                ? integrate_small_facet<Dim>(kernel_, facet, normal, local)
                                                : integrate_facet<Dim>(kernel_, facet, normal, local);
      // At the rim of the support rounding may leave next to nothing of either sign.
      if (!(integrals.area > 0.0)) continue;
      seen.solid += integrals.solid;
      moment += integrals.solid * Mat<Dim>::Identity() - integrals.first * normal.transpose();

      // Sums first; the normal is the mean once they are whole.
      constexpr double same_direction = 0.985;
      const double plane = (local - facet[0]).dot(normal);
      const bool in_front = plane > 0.0;
      const double same_plane = 0.25 * kernel_.smoothing_length();
      auto contact = std::find_if(contacts.begin() + of_obstacle, contacts.end(), [&](const WallContact<Dim>& c) {
        return in_front == (c.distance > 0.0) && c.normal.dot(normal) > same_direction * c.normal.norm() &&
               std::abs(c.first.dot(normal) / c.area + plane) < same_plane;
      });
      if (contact == contacts.end()) {
        const double unset = in_front ? 1.0 : -1.0;
        contact = contacts.insert(contact, {Vec<Dim>::Zero(), Vec<Dim>::Zero(), unset, 0.0, 0.0, 0.0, 0.0, 0.0, o, Vec<Dim>::Zero(), Vec<Dim>::Zero()});
      }
      contact->normal += integrals.area * normal;
      contact->first += integrals.first;
      contact->area += integrals.area;
      contact->solid += integrals.solid;
    }
    const Mat<Dim>& rotation = placed.begin.rotation;
    seen.moment += rotation * moment * rotation.transpose();
    for (auto contact = contacts.begin() + of_obstacle; contact != contacts.end(); ++contact) {
      contact->normal = rotation * contact->normal;
      contact->first = rotation * contact->first;
    }
  }
  seen.moment = 0.5 * (seen.moment + seen.moment.transpose()).eval();
  for (auto contact = contacts.begin() + own; contact != contacts.end(); ++contact) {
    const double facets_area = contact->area;
    contact->area = contact->normal.norm();
    contact->normal /= contact->area;
    contact->distance = -contact->first.dot(contact->normal) / facets_area;
    const PlacedObstacle<Dim>& placed = colliders.placed()[contact->obstacle];
    contact->velocity = placed.velocity_at(position, contact->normal);
    contact->acceleration = wall_acceleration_at<Dim>(placed, position);
    // A plane seen from behind takes back what a plane in front of it gave: nothing goes on linearly from there.
    if (contact->distance <= 0.0) continue;
    const double distance = std::max(contact->distance, least_distance_);
    contact->stretch = (contact->distance * contact->area + contact->solid) / distance;
    contact->push = 2.0 * contact->area * std::max(1.0, 0.5 * spacing_ / distance);
    contact->conductance = contact->area / distance;
  }
}

template class Walls<1>;
template class Walls<2>;
template class Walls<3>;

}  // namespace smelt
