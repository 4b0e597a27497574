#include "core/sph/collision.h"

#include "core/error.h"

#include <utility>

namespace smelt {

namespace {

/// A triangle in reach of a step, and the obstacle it belongs to.
struct Candidate {
  std::uint32_t obstacle;
  std::uint32_t simplex;
};

template <int Dim>
Vec<Dim> respond(const Vec<Dim>& velocity, const Vec<Dim>& normal, const ContactResponse& response) {
  const double normal_speed = velocity.dot(normal);
  const Vec<Dim> tangential = velocity - normal_speed * normal;
  // What already moves away is left alone: the obstacle only pushes.
  return response.friction * tangential + (normal_speed < 0.0 ? -response.restitution : 1.0) * normal_speed * normal;
}

}  // namespace

template <int Dim>
void Colliders<Dim>::add(std::vector<Simplex<Dim>> simplices, const ContactResponse& response) {
  obstacles_.push_back({SimplexBvh<Dim>(std::move(simplices)), response});
}

template <int Dim>
bool Colliders<Dim>::move_sphere(double radius, double dt, Vec<Dim>& position, Vec<Dim>& transport,
                                 Vec<Dim>& velocity) const {
  // Broad phase, once for the whole step: responses never lengthen the path.
  thread_local std::vector<std::uint32_t> found;
  thread_local std::vector<Candidate> candidates;
  candidates.clear();
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    found.clear();
    // Twice the radius: a sphere that starts inside an obstacle is first moved out, by up to its radius.
    obstacles_[o].bvh.find_near(position, 2.0 * radius + dt * transport.norm(), found);
    for (const std::uint32_t simplex : found) candidates.push_back({static_cast<std::uint32_t>(o), simplex});
  }
  if (candidates.empty()) {
    position += dt * transport;
    return false;
  }
  const auto simplex_of = [&](const Candidate& c) -> const Simplex<Dim>& {
    return obstacles_[c.obstacle].bvh.simplices()[c.simplex];
  };

  // Out of what it overlaps.
  for (const Candidate& candidate : candidates) {
    const Vec<Dim> from_obstacle = position - closest_point<Dim>(position, simplex_of(candidate));
    const double distance = from_obstacle.norm();
    if (distance > 0.0 && distance < radius) position += (radius - distance) / distance * from_obstacle;
  }

  bool hit = false;
  double remaining = dt;
  for (int bounce = 0; bounce < max_bounces; ++bounce) {
    std::optional<SweepContact<Dim>> first;
    const Candidate* touched = nullptr;
    for (const Candidate& candidate : candidates) {
      const auto contact = sweep_sphere<Dim>(position, remaining * transport, radius, simplex_of(candidate));
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
    remaining *= 1.0 - first->time;
    const ContactResponse& response = obstacles_[touched->obstacle].response;
    transport = respond<Dim>(transport, first->normal, response);
    velocity = respond<Dim>(velocity, first->normal, response);
  }
  return hit;
}

template class Colliders<1>;
template class Colliders<2>;
template class Colliders<3>;

}  // namespace smelt
