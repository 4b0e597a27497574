#include "core/sph/walls.h"

#include "core/error.h"
#include "core/geometry/facet.h"
#include "core/parallel.h"
#include "core/sph/reorder.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace smelt {

namespace {

/// +1 where a particle is in front of an obstacle, -1 behind. A solid's front is outside, whatever the particle sees; a
/// sheet has a front on the side of the particle: that of the nearest facet, of those equally near the one whose plane
/// is farthest.
template <int Dim>
double side_of(const Obstacle<Dim>& obstacle, const SimplexBvh<Dim>& bvh, const Vec<Dim>& local,
               const std::vector<std::uint32_t>& facets) {
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

/// The acceleration that fluid at the wall shares. What slips does not go round with the wall: it has no part in the
/// centripetal one.
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
  auto contact =
      std::find_if(contacts.begin() + static_cast<std::ptrdiff_t>(own), contacts.end(), [&](const WallContact<Dim>& c) {
        return in_front == (c.distance > 0.0) && c.normal.dot(piece.normal) > same_direction * c.normal.norm() &&
               std::abs(c.first.dot(piece.normal) / c.area + piece.plane) < same_plane;
      });
  if (contact == contacts.end()) {
    const double unset = in_front ? 1.0 : -1.0;
    contact = contacts.insert(contact, {Vec<Dim>::Zero(), Vec<Dim>::Zero(), unset, 0.0, 0.0, 0.0, 0.0, 0.0, obstacle,
                                        Vec<Dim>::Zero(), Vec<Dim>::Zero()});
  }
  contact->normal += piece.area_vector;
  contact->first += piece.first;
  contact->area += piece.area;
  contact->solid += piece.solid;
}

}  // namespace

template <int Dim>
void Walls<Dim>::reset(std::size_t n) {
  slot_.assign(n, -1);
  apart_.assign(n, 0.0F);
  neighbours_.clear();
  views_.clear();
  way_ = 0.0;
}

template <int Dim>
void Walls<Dim>::reorder(std::span<const std::int32_t> order, std::span<std::byte> scratch) {
  smelt::reorder(slot_, order, scratch);
  smelt::reorder(apart_, order, scratch);
  sort_slots();
}

template <int Dim>
void Walls<Dim>::keep(std::span<const std::int32_t> kept) {
  keep_only(slot_, kept);
  keep_only(apart_, kept);
  sort_slots();
}

/// Slots follow the particles' order, so that what is near in space is near in memory; those that no particle has any
/// more go.
template <int Dim>
void Walls<Dim>::sort_slots() {
  std::vector<std::size_t> from;  // slot k is to be what slot from[k] is
  std::vector<bool> taken(neighbours_.size(), false);
  for (std::size_t i = 0; i < slot_.size(); ++i) {
    if (slot_[i] < 0) continue;
    const auto before = static_cast<std::size_t>(slot_[i]);
    neighbours_[before].particle = static_cast<std::int32_t>(i);
    slot_[i] = static_cast<std::int32_t>(from.size());
    taken[before] = true;
    from.push_back(before);
  }
  const std::size_t n_kept = from.size();
  for (std::size_t k = 0; k < taken.size(); ++k)
    if (!taken[k]) from.push_back(k);
  for (std::size_t k = 0; k < from.size(); ++k) {
    std::size_t now = from[k];
    while (now < k) now = from[now];  // where the swaps so far have put it
    if (now == k) continue;
    std::swap(neighbours_[k], neighbours_[now]);
    std::swap(views_[k], views_[now]);
  }
  neighbours_.resize(n_kept);
  views_.resize(n_kept);
}

template <int Dim>
void Walls<Dim>::update(const Colliders<Dim>& colliders, std::span<const Vec<Dim>> position,
                        std::span<const Vec<Dim>> velocity, double dt) {
  CHECK_EQ(position.size(), slot_.size());
  if constexpr (Dim == 3)
    if (!sample_kernel_) {
      sample_kernel_.emplace(kernel_);
      for (const auto& placed : colliders.placed())
        trees_.emplace_back(placed.obstacle.wall ? std::span(placed.bvh.simplices()) : std::span<const Simplex<3>>{});
    }
  way_ += colliders.step_way();
  take_in(colliders, position);
  constexpr std::size_t grain = 32;  // looking up takes long
  parallel_blocks(
      neighbours_.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          const auto i = static_cast<std::size_t>(neighbours_[k].particle);
          // Where obstacles move, the sums are made anew at every step.
          refresh(colliders, position[i],
                  colliders.step_way() > 0.0 ? Vec<Dim>::Zero() : half_of_a_little(velocity[i], dt), k);
        }
      },
      grain);
  drop_blind();
}

/// Whether particle `i`, which has no slot, is in reach of a wall; else, how far it is.
template <int Dim>
bool Walls<Dim>::comes_near(const Colliders<Dim>& colliders, std::span<const Vec<Dim>> position, std::size_t i) {
  const double limit = reach() + 2.0 * kernel_.smoothing_length();
  double nearest = limit;
  for (const PlacedObstacle<Dim>& placed : colliders.placed())
    if (placed.obstacle.wall && !placed.gone)
      nearest = std::min(nearest, placed.bvh.distance(placed.begin.to_rest(position[i]), nearest));
  apart_[i] = round_down(nearest - kernel_.support_radius() + way_);
  return nearest < reach();
}

/// Gives a slot to what has come near. In the order of the particles: what depends on it is the same on any number of
/// threads.
template <int Dim>
void Walls<Dim>::take_in(const Colliders<Dim>& colliders, std::span<const Vec<Dim>> position) {
  std::vector<std::vector<std::int32_t>> come((position.size() + block_size - 1) / block_size);
  parallel_blocks(
      come.size(),
      [&](std::size_t block, std::size_t) {
        for (std::size_t i = block * block_size; i < std::min(position.size(), (block + 1) * block_size); ++i)
          if (slot_[i] < 0 && apart_[i] <= way_ && comes_near(colliders, position, i))
            come[block].push_back(static_cast<std::int32_t>(i));
      },
      1);
  for (const auto& block : come)
    for (const std::int32_t i : block) {
      slot_[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(neighbours_.size());
      neighbours_.push_back({i, 0.0, Mat<Dim>::Zero(), {}});
    }
  views_.resize(neighbours_.size());
}

/// Takes the slots of those that no longer have anything in reach.
template <int Dim>
void Walls<Dim>::drop_blind() {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < neighbours_.size(); ++k) {
    const auto i = static_cast<std::size_t>(neighbours_[k].particle);
    if (views_[k].sights.empty()) {
      slot_[i] = -1;
      apart_[i] = round_down(way_);  // looked at anew at the next step
      continue;
    }
    if (kept != k) {
      neighbours_[kept] = std::move(neighbours_[k]);
      views_[kept] = std::move(views_[k]);
      slot_[i] = static_cast<std::int32_t>(kept);
    }
    ++kept;
  }
  neighbours_.resize(kept);
  views_.resize(kept);
}

/// Half of the way from one making of the sums to the next; a whole number of steps. From its beginning to its end they
/// then are ahead of the particle and behind it by as much.
template <int Dim>
Vec<Dim> Walls<Dim>::half_of_a_little(const Vec<Dim>& velocity, double dt) const {
  const double speed = velocity.norm(), step = dt * speed;
  if (speed == 0.0) return Vec<Dim>::Zero();
  return 0.5 / speed * (step > 0.0 ? step * std::floor(little() / step) : little()) * velocity;
}

template <int Dim>
void Walls<Dim>::refresh(const Colliders<Dim>& colliders, const Vec<Dim>& position, const Vec<Dim>& ahead,
                         std::size_t slot) {
  View& view = views_[slot];
  WallNeighbour<Dim>& seen = neighbours_[slot];
  if (view.way < 0.0 || (position - view.origin).norm() + way_ - view.way > slack()) {
    look_up(colliders, position, view);
    if (view.sights.empty()) return;
  }
  const bool stands = view.summed_way == way_ && (position - view.summed_from).norm() <= little();
  if (!stands) {
    sum(colliders, position + ahead, view);
    view.summed_from = position;
  }
  if (!shift(view, position - view.summed_at, seen)) {
    sum(colliders, position, view);
    view.summed_from = position;
    shift(view, Vec<Dim>::Zero(), seen);
  }
  for (WallContact<Dim>& contact : seen.contacts) complete(colliders.placed()[contact.obstacle], position, contact);
}

template <int Dim>
void Walls<Dim>::look_up(const Colliders<Dim>& colliders, const Vec<Dim>& position, View& view) const {
  view.origin = position;
  view.way = way_;
  view.summed_way = -1.0;
  view.sights.clear();
  view.facets.clear();
  view.patches_end.clear();
  view.samples.clear();
  thread_local std::vector<std::uint32_t> nearest;
  [[maybe_unused]] thread_local WallPatches patches;
  for (std::uint32_t o = 0; o < colliders.placed().size(); ++o) {
    const auto& placed = colliders.placed()[o];
    if (!placed.obstacle.wall || placed.gone) continue;
    Sight sight;
    sight.obstacle = o;
    sight.origin = placed.begin.to_rest(position);
    const double distance = placed.bvh.distance(sight.origin, reach());
    if (distance >= reach()) continue;
    if (!placed.obstacle.closed) {
      nearest.clear();
      placed.bvh.find_near(sight.origin, (1.0 + 1e-6) * distance, nearest);
      sight.side = side_of<Dim>(placed.obstacle, placed.bvh, sight.origin, nearest);
    }
    if constexpr (Dim == 3) {
      trees_[o].gather(sight.origin, kernel_.smoothing_length(), kernel_.support_radius(), slack(), patches,
                       view.facets);
      for (std::size_t p = 0; p < patches.n; ++p) {
        const WallPatch& patch = patches.patch[p];
        if (patch.samples.empty()) continue;
        pack_wall_samples(patch.samples, sight.origin, sight.side, view.samples);
        view.patches_end.push_back(view.samples.size());
      }
    } else {
      placed.bvh.find_near(sight.origin, reach(), view.facets);
    }
    sight.facets_end = view.facets.size();
    sight.patches_end = view.patches_end.size();
    view.sights.push_back(sight);
  }
}

/// The sums over everything in sight: geometry alone, without what depends on how the obstacles move.
template <int Dim>
void Walls<Dim>::sum(const Colliders<Dim>& colliders, const Vec<Dim>& position, View& view) const {
  view.summed_at = position;
  view.summed_way = way_;
  WallNeighbour<Dim>& sums = view.sums;
  sums.solid = 0.0;
  sums.moment.setZero();
  sums.contacts.clear();
  for (std::size_t k = 0; k < view.sights.size(); ++k) {
    const PlacedObstacle<Dim>& placed = colliders.placed()[view.sights[k].obstacle];
    sum_sight(placed, placed.begin.to_rest(position), k, view);
  }
  sums.moment = 0.5 * (sums.moment + sums.moment.transpose()).eval();
  for (WallContact<Dim>& contact : sums.contacts) {
    const double facets_area = contact.area;
    contact.area = contact.normal.norm();
    contact.normal /= contact.area;
    contact.distance = -contact.first.dot(contact.normal) / facets_area;
  }
}

/// Everything at rest first, then turned to where the obstacle is.
template <int Dim>
void Walls<Dim>::sum_sight(const PlacedObstacle<Dim>& placed, const Vec<Dim>& local, std::size_t k, View& view) const {
  const Sight& sight = view.sights[k];
  WallNeighbour<Dim>& sums = view.sums;
  const double same_plane = 0.25 * kernel_.smoothing_length();
  const std::size_t own = sums.contacts.size();
  Mat<Dim> moment = Mat<Dim>::Zero();
  for (std::size_t f = k == 0 ? 0 : view.sights[k - 1].facets_end; f < sight.facets_end; ++f) {
    const Simplex<Dim>& facet = placed.bvh.simplices()[view.facets[f]];
    const Vec<Dim> normal = sight.side * facet_normal<Dim>(facet);
    const FacetIntegrals<Dim> integrals = is_small<Dim>(facet, local, kernel_.smoothing_length())
                                              ? integrate_small_facet<Dim>(kernel_, facet, normal, local)
                                              : integrate_facet<Dim>(kernel_, facet, normal, local);
    // At the rim of the support rounding may leave next to nothing of either sign.
    if (!(integrals.area > 0.0)) continue;
    sums.solid += integrals.solid;
    moment += integrals.solid * Mat<Dim>::Identity() - integrals.first * normal.transpose();
    add_to_contact<Dim>({integrals.area, integrals.area * normal, integrals.first, integrals.solid, normal,
                         (local - facet[0]).dot(normal)},
                        sight.obstacle, same_plane, own, sums.contacts);
  }
  if constexpr (Dim == 3) {
    for (std::size_t p = k == 0 ? 0 : view.sights[k - 1].patches_end; p < sight.patches_end; ++p) {
      const std::size_t begin = p == 0 ? 0 : view.patches_end[p - 1];
      const SampleSums patch = sum_wall_samples(
          *sample_kernel_, {view.samples.data() + begin, view.patches_end[p] - begin}, local - sight.origin);
      if (!(patch.area > 0.0)) continue;
      sums.solid += patch.solid;
      moment += patch.moment;
      const Vec3 normal = patch.normal.normalized();
      add_to_contact<3>(
          {patch.area, patch.normal, patch.first, patch.solid, normal, -patch.first.dot(normal) / patch.area},
          sight.obstacle, same_plane, own, sums.contacts);
    }
  }
  const Mat<Dim>& rotation = placed.begin.rotation;
  sums.moment += rotation * moment * rotation.transpose();
  for (auto contact = sums.contacts.begin() + static_cast<std::ptrdiff_t>(own); contact != sums.contacts.end();
       ++contact) {
    contact->normal = rotation * contact->normal;
    contact->first = rotation * contact->first;
  }
}

/// The sums of a view after the particle has moved a little, as those of a plane change with its distance: with d the
/// contact's distance and s = 1 + dA/A of a whole plane, A' = s A, Gamma' = Gamma - (A + A')/2 dd (exact to the second
/// order, as dGamma/dd = -A), and first' = s first, its part along n times d'/d as well. False where the particle would
/// be in the plane.
template <int Dim>
bool Walls<Dim>::shift(const View& view, const Vec<Dim>& moved, WallNeighbour<Dim>& seen) const {
  seen.solid = view.sums.solid;
  seen.moment = view.sums.moment;
  seen.contacts = view.sums.contacts;
  if constexpr (Dim == 3) {
    if (moved.isZero(0.0)) return true;
    for (WallContact<3>& contact : seen.contacts) {
      if (contact.distance <= 0.0) continue;
      const Vec3& n = contact.normal;
      const double nearer = moved.dot(n), distance = contact.distance + nearer;
      if (distance <= 0.1 * contact.distance) return false;
      const PlaneIntegral plane = integrate_plane(kernel_, contact.distance);
      const double scale = plane.area > 0.0 ? std::max(0.0, 1.0 + plane.slope / plane.area * nearer) : 1.0;
      const Vec3 first = scale * (contact.first + (distance / contact.distance - 1.0) * contact.first.dot(n) * n);
      const double lost = 0.5 * (1.0 + scale) * contact.area * nearer;
      const Mat3 tilt = 0.5 * (first - contact.first) * n.transpose();
      seen.solid -= lost;
      seen.moment -= lost * Mat3::Identity() + tilt + tilt.transpose();
      contact.solid -= lost;
      contact.first = first;
      contact.area *= scale;
      contact.distance = distance;
    }
  }
  return true;
}

/// What follows from a contact's sums and its obstacle's motion.
template <int Dim>
void Walls<Dim>::complete(const PlacedObstacle<Dim>& placed, const Vec<Dim>& position,
                          WallContact<Dim>& contact) const {
  contact.velocity = placed.velocity_at(position, contact.normal);
  contact.acceleration = wall_acceleration_at<Dim>(placed, position);
  // A plane seen from behind takes back what a plane in front of it gave: nothing goes on linearly from there.
  if (contact.distance <= 0.0) return;
  const double distance = std::max(contact.distance, least_distance_);
  contact.stretch = (contact.distance * contact.area + contact.solid) / distance;
  contact.push = 2.0 * contact.area * std::max(1.0, 0.5 * spacing_ / distance);
  contact.conductance = contact.area / distance;
}

template class Walls<1>;
template class Walls<2>;
template class Walls<3>;

}  // namespace smelt
