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
template <int Dim>
double side_of(const Obstacle<Dim>& obstacle, const SimplexBvh<Dim>& bvh, const Vec<Dim>& local, const std::vector<std::uint32_t>& facets) {
  if (obstacle.closed) return 1.0;
  double nearest = std::numeric_limits<double>::infinity();
  double height = 0.0;
  for (const std::uint32_t f : facets) {
    const Simplex<Dim>& facet = bvh.simplices()[f];
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

/// What a facet, or a patch of samples, adds to the contact of its plane; a new contact where there is none.
template <int Dim>
struct Piece {
  double area;           ///< A
  Vec<Dim> area_vector;  ///< int W n dS
  Vec<Dim> first;
  double solid;
  Vec<Dim> normal;
  double plane;  ///< distance of the particle in front of it [m]
};

template <int Dim>
void add_to_contact(const Piece<Dim>& piece, std::uint32_t obstacle, double same_plane, std::size_t own,
                    std::vector<WallContact<Dim>>& contacts) {  // `own`: of this obstacle, from there on
  // Sums first; the normal is the mean once they are whole.
  constexpr double same_direction = 0.985;
  const bool in_front = piece.plane > 0.0;
  auto contact = std::find_if(contacts.begin() + static_cast<std::ptrdiff_t>(own), contacts.end(), [&](const WallContact<Dim>& c) {
    return in_front == (c.distance > 0.0) &&
           c.normal.dot(piece.normal) > same_direction * c.normal.norm() &&
           std::abs(c.first.dot(piece.normal) / c.area + piece.plane) < same_plane;
  });
  if (contact == contacts.end()) {
    const double unset = in_front ? 1.0 : -1.0;
    contact = contacts.insert(contact, {Vec<Dim>::Zero(), Vec<Dim>::Zero(), unset, 0.0, 0.0, 0.0, 0.0, 0.0, obstacle, Vec<Dim>::Zero(), Vec<Dim>::Zero()});
  }
  contact->normal += piece.area_vector;
  contact->first += piece.first;
  contact->area += piece.area;
  contact->solid += piece.solid;
}

}  // namespace

template <int Dim>
void Walls<Dim>::find(const Colliders<Dim>& colliders, std::span<const Vec<Dim>> position, double slack) {
  if constexpr (Dim == 3)
    if (!sample_kernel_) {
      sample_kernel_.emplace(kernel_);
      for (const auto& placed : colliders.placed())
        trees_.emplace_back(placed.obstacle.wall ? std::span(placed.bvh.simplices()) : std::span<const Simplex<3>>{});
    }
  found_.resize((position.size() + block_size - 1) / block_size);
  parallel_blocks(found_.size(), [&](std::size_t b, std::size_t) { find_in_block(colliders, position, b * block_size, slack, found_[b]); }, 1);

  slot_.assign(position.size(), -1);
  neighbours_.clear();
  first_.clear();
  for (const Found& block : found_) {
    first_.push_back(neighbours_.size());
    for (const std::int32_t particle : block.particles) {
      slot_[static_cast<std::size_t>(particle)] = static_cast<std::int32_t>(neighbours_.size());
      neighbours_.push_back({particle, 0.0, Mat<Dim>::Zero(), {}});
    }
  }
}

template <int Dim>
void Walls<Dim>::find_in_block(const Colliders<Dim>& colliders, std::span<const Vec<Dim>> position, std::size_t begin, double slack,
                               Found& found) const {
  found.particles.clear();
  found.sights_end.clear();
  found.sights.clear();
  found.facets.clear();
  found.patches_end.clear();
  found.samples.clear();
  const double reach = kernel_.support_radius() + slack;
  std::vector<std::uint32_t> nearest;
  WallPatches patches;
  for (std::size_t i = begin; i < std::min(position.size(), begin + block_size); ++i) {
    const std::size_t before = found.sights.size();
    for (std::uint32_t o = 0; o < colliders.placed().size(); ++o) {
      const auto& placed = colliders.placed()[o];
      if (!placed.obstacle.wall || placed.gone) continue;
      Sight sight;
      sight.obstacle = o;
      sight.origin = placed.begin.to_rest(position[i]);
      const double distance = placed.bvh.distance(sight.origin, reach);
      if (distance >= reach) continue;
      if (!placed.obstacle.closed) {
        nearest.clear();
        placed.bvh.find_near(sight.origin, (1.0 + 1e-6) * distance, nearest);
        sight.side = side_of<Dim>(placed.obstacle, placed.bvh, sight.origin, nearest);
      }
      if constexpr (Dim == 3) {
        trees_[o].gather(sight.origin, kernel_.smoothing_length(), kernel_.support_radius(), slack, patches, found.facets);
        for (std::size_t p = 0; p < patches.n; ++p) {
          const WallPatch& patch = patches.patch[p];
          if (patch.samples.empty()) continue;
          pack_wall_samples(patch.samples, sight.origin, sight.side, found.samples);
          found.patches_end.push_back(found.samples.size());
        }
      } else {
        placed.bvh.find_near(sight.origin, reach, found.facets);
      }
      sight.facets_end = found.facets.size();
      sight.patches_end = found.patches_end.size();
      found.sights.push_back(sight);
    }
    if (found.sights.size() == before) continue;
    found.particles.push_back(static_cast<std::int32_t>(i));
    found.sights_end.push_back(found.sights.size());
  }
}

template <int Dim>
void Walls<Dim>::reorder(const std::vector<std::int32_t>& order) {
  if (slot_.size() != order.size()) return;  // nothing was found yet
  std::vector<std::int32_t> slot(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    slot[i] = slot_[static_cast<std::size_t>(order[i])];
    if (slot[i] >= 0) neighbours_[static_cast<std::size_t>(slot[i])].particle = static_cast<std::int32_t>(i);
  }
  slot_.swap(slot);
}

template <int Dim>
void Walls<Dim>::update(const Colliders<Dim>& colliders, std::span<const Vec<Dim>> position) {
  contacts_.resize(found_.size());
  parallel_blocks(found_.size(), [&](std::size_t b, std::size_t) {
    const Found& found = found_[b];
    std::vector<WallContact<Dim>>& contacts = contacts_[b];
    contacts.clear();
    std::array<std::size_t, block_size + 1> first{};
    for (std::size_t k = 0; k < found.particles.size(); ++k) {
      append_contacts(colliders, position[static_cast<std::size_t>(neighbours_[first_[b] + k].particle)], found, k, first_[b] + k, contacts);
      first[k + 1] = contacts.size();
    }
    for (std::size_t k = 0; k < found.particles.size(); ++k)
      neighbours_[first_[b] + k].contacts = {contacts.data() + first[k], first[k + 1] - first[k]};
  }, 1);
}

template <int Dim>
void Walls<Dim>::append_contacts(const Colliders<Dim>& colliders, const Vec<Dim>& position, const Found& found, std::size_t k,
                                 std::size_t slot, std::vector<WallContact<Dim>>& contacts) {
  WallNeighbour<Dim>& seen = neighbours_[slot];
  seen.solid = 0.0;
  seen.moment.setZero();
  const auto own = static_cast<std::ptrdiff_t>(contacts.size());
  const double same_plane = 0.25 * kernel_.smoothing_length();
  for (std::size_t s = k == 0 ? 0 : found.sights_end[k - 1]; s < found.sights_end[k]; ++s) {
    const Sight& sight = found.sights[s];
    const PlacedObstacle<Dim>& placed = colliders.placed()[sight.obstacle];
    const SimplexBvh<Dim>& bvh = placed.bvh;
    // Everything at rest first, then turned to where the obstacle is.
    const std::size_t of_obstacle = contacts.size();
    Mat<Dim> moment = Mat<Dim>::Zero();
    const Vec<Dim> local = placed.begin.to_rest(position);
    for (std::size_t f = s == 0 ? 0 : found.sights[s - 1].facets_end; f < sight.facets_end; ++f) {
      const Simplex<Dim>& facet = bvh.simplices()[found.facets[f]];
      const Vec<Dim> normal = sight.side * facet_normal<Dim>(facet);
      const FacetIntegrals<Dim> integrals = is_small<Dim>(facet, local, kernel_.smoothing_length())
                                                ? integrate_small_facet<Dim>(kernel_, facet, normal, local)
                                                : integrate_facet<Dim>(kernel_, facet, normal, local);
      // At the rim of the support rounding may leave next to nothing of either sign.
      if (!(integrals.area > 0.0)) continue;
      seen.solid += integrals.solid;
      moment += integrals.solid * Mat<Dim>::Identity() - integrals.first * normal.transpose();
      add_to_contact<Dim>({integrals.area, integrals.area * normal, integrals.first, integrals.solid, normal, (local - facet[0]).dot(normal)},
                          sight.obstacle, same_plane, of_obstacle, contacts);
    }
    if constexpr (Dim == 3) {
      for (std::size_t p = s == 0 ? 0 : found.sights[s - 1].patches_end; p < sight.patches_end; ++p) {
        const std::size_t begin = p == 0 ? 0 : found.patches_end[p - 1];
        const SampleSums sums =
            sum_wall_samples(*sample_kernel_, {found.samples.data() + begin, found.patches_end[p] - begin}, local - sight.origin);
        if (!(sums.area > 0.0)) continue;
        seen.solid += sums.solid;
        moment += sums.moment;
        const Vec3 normal = sums.normal.normalized();
        add_to_contact<3>({sums.area, sums.normal, sums.first, sums.solid, normal, -sums.first.dot(normal) / sums.area}, sight.obstacle,
                          same_plane, of_obstacle, contacts);
      }
    }
    const Mat<Dim>& rotation = placed.begin.rotation;
    seen.moment += rotation * moment * rotation.transpose();
    for (auto contact = contacts.begin() + static_cast<std::ptrdiff_t>(of_obstacle); contact != contacts.end(); ++contact) {
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
