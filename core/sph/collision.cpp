#include "core/sph/collision.h"

#include "core/error.h"

#include <algorithm>
#include <utility>

namespace smelt {

namespace {

/// A facet in reach of a step, and the obstacle it belongs to.
struct Candidate {
  std::uint32_t obstacle;
  std::uint32_t facet;
};

/// The velocity after a hit; `velocity` is relative to the obstacle's surface.
template <int Dim>
Vec<Dim> respond(const Vec<Dim>& velocity, const Vec<Dim>& normal, const ContactResponse& response) {
  const double normal_speed = velocity.dot(normal);
  const Vec<Dim> tangential = velocity - normal_speed * normal;
  // What already moves away is left alone: the obstacle only pushes.
  return response.friction * tangential + (normal_speed < 0.0 ? -response.restitution : 1.0) * normal_speed * normal;
}

}  // namespace

template <int Dim>
void Colliders<Dim>::add(Obstacle<Dim> obstacle) {
  std::vector<Simplex<Dim>> facets = std::move(obstacle.facets);
  obstacle.facets.clear();
  placed_.push_back({std::move(obstacle), SimplexBvh<Dim>(std::move(facets))});
}

template <int Dim>
bool Colliders<Dim>::has_walls() const {
  return std::any_of(placed_.begin(), placed_.end(), [](const Placed& p) { return p.obstacle.wall; });
}

template <int Dim>
double Colliders<Dim>::max_speed() const {
  double speed = 0.0;
  for (const Placed& p : placed_) speed = std::max(speed, p.obstacle.velocity.norm() + p.obstacle.surface_velocity.norm());
  return speed;
}

template <int Dim>
double Colliders<Dim>::max_obstacle_speed() const {
  double speed = 0.0;
  for (const Placed& p : placed_) speed = std::max(speed, p.obstacle.velocity.norm());
  return speed;
}

template <int Dim>
void Colliders<Dim>::place_at(double time) {
  for (Placed& p : placed_) p.displacement = time * p.obstacle.velocity;
}

template <int Dim>
bool Colliders<Dim>::move_sphere(double radius, double dt, Vec<Dim>& position, Vec<Dim>& transport,
                                 Vec<Dim>& velocity) const {
  // Broad phase, once for the whole step. A response never lengthens the path relative to what was hit, and each obstacle comes nearer
  // by its own speed: twice the fastest, since it may be returned.
  const double reach = 2.0 * radius + dt * (transport.norm() + 3.0 * max_speed());
  thread_local std::vector<std::uint32_t> found;
  thread_local std::vector<Candidate> candidates;
  candidates.clear();
  for (std::size_t o = 0; o < placed_.size(); ++o) {
    const Placed& placed = placed_[o];
    found.clear();
    // Twice the radius: a sphere that starts inside an obstacle is first moved out, by up to its radius.
    placed.bvh.find_near(position - placed.displacement, reach, found);
    for (const std::uint32_t facet : found) candidates.push_back({static_cast<std::uint32_t>(o), facet});
  }
  if (candidates.empty()) {
    position += dt * transport;
    return false;
  }
  const auto radius_at = [&](const Candidate& c) { return (placed_[c.obstacle].obstacle.wall ? wall_guard : 1.0) * radius; };
  const auto facet_of = [&](const Candidate& c) -> const Simplex<Dim>& { return placed_[c.obstacle].bvh.simplices()[c.facet]; };

  // Out of what it overlaps.
  for (const Candidate& candidate : candidates) {
    const Vec<Dim> local = position - placed_[candidate.obstacle].displacement;
    const Vec<Dim> from_obstacle = local - closest_point<Dim>(local, facet_of(candidate));
    const double distance = from_obstacle.norm();
    const double least = radius_at(candidate);
    if (distance > 0.0 && distance < least) position += (least - distance) / distance * from_obstacle;
  }

  bool hit = false;
  double elapsed = 0.0;
  Vec<Dim> carried = Vec<Dim>::Zero();
  for (int bounce = 0; bounce < max_bounces; ++bounce) {
    const double remaining = dt - elapsed;
    std::optional<SweepContact<Dim>> first;
    const Candidate* touched = nullptr;
    for (const Candidate& candidate : candidates) {
      // In the frame that moves with the obstacle.
      const Placed& placed = placed_[candidate.obstacle];
      const Vec<Dim> local = position - placed.displacement - elapsed * placed.obstacle.velocity;
      const auto contact = sweep_sphere<Dim>(local, remaining * (transport - placed.obstacle.velocity), radius_at(candidate),
                                             facet_of(candidate));
      if (contact && (!first || contact->time < first->time)) {
        first = contact;
        touched = &candidate;
      }
    }
    if (!first) {
      position += remaining * transport;
      return hit;
    }
    hit = true;
    position += first->time * remaining * transport;
    elapsed += first->time * remaining;
    const Obstacle<Dim>& obstacle = placed_[touched->obstacle].obstacle;
    const Vec<Dim> surface = obstacle.velocity_at(first->normal);
    carried = obstacle.velocity;
    transport = surface + respond<Dim>(transport - surface, first->normal, obstacle.response);
    velocity = surface + respond<Dim>(velocity - surface, first->normal, obstacle.response);
  }
  position += (dt - elapsed) * carried;
  return hit;
}

template class Colliders<1>;
template class Colliders<2>;
template class Colliders<3>;

}  // namespace smelt
