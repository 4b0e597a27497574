#include "core/sph/collision.h"

#include "core/error.h"
#include "core/geometry/facet.h"
#include "core/sph/body_contacts.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace smelt {

namespace {

template <int Dim>
using Obstacles = std::vector<PlacedObstacle<Dim>>;

/// A sphere on its way through a step.
template <int Dim>
struct Moving {
  Vec<Dim> position;
  Vec<Dim> transport;
  Vec<Dim> velocity;
  double share = 0.0;                            ///< of the step that is over
  const PlacedObstacle<Dim>* carrier = nullptr;  ///< what it touched last: it goes straight in that frame
  std::vector<BodyHit<Dim>>* hits = nullptr;
  std::uint32_t carrier_index = 0;
  Vec<Dim> relative = Vec<Dim>::Zero();  ///< transport less the carrier's motion there [m/s]: exactly 0 for what sticks
};

/// The way to where it would be at the end of a leg if it hit nothing.
template <int Dim>
struct Way {
  Vec<Dim> goal;
  Vec<Dim> in_carrier;  ///< in the carrier's frame, where there is one
};

/// What it meets first, or nothing.
template <int Dim>
struct FirstHit {
  const PlacedObstacle<Dim>* touched = nullptr;
  std::uint32_t obstacle = 0;
  double time = 0.0;                   ///< share of the way
  Vec<Dim> normal = Vec<Dim>::Zero();  ///< like the next, in the obstacle's own frame
  Vec<Dim> place = Vec<Dim>::Zero();   ///< of the centre [m]
};

template <int Dim>
double radius_at(const PlacedObstacle<Dim>& placed, double radius) {
  return (placed.obstacle.wall ? Colliders<Dim>::wall_guard : 1.0) * radius;
}

/// Moves a sphere out of what it overlaps, the nearest first, as far as its centre gets without passing another facet.
template <int Dim>
void push_out(const Obstacles<Dim>& obstacles, double radius, Vec<Dim>& position) {
  for (const PlacedObstacle<Dim>& placed : obstacles) {
    if (placed.gone) continue;
    const double least = radius_at(placed, radius);
    Vec<Dim> local = placed.begin.to_rest(position);
    bool moved = false;
    for (int pass = 0; pass < Colliders<Dim>::max_bounces; ++pass) {
      const auto touched = placed.bvh.nearest(local, least);
      if (!touched) break;
      // From a place on the facet itself, to its front.
      const double distance = touched->distance;
      const Vec<Dim> way = distance > 0.0
                               ? Vec<Dim>((least - distance) / distance * touched->offset)
                               : Vec<Dim>(least * facet_normal<Dim>(placed.bvh.simplices()[touched->simplex]));
      double share = 1.0;
      // Nothing is nearer than what it leaves: there may be something in the way only if it comes from deep inside.
      if (distance < 0.51 * least)
        if (const auto hit = placed.bvh.first_contact(local, way, Colliders<Dim>::squeezed * least, touched->simplex))
          share = hit->contact.time;
      local += share * way;
      moved = true;
    }
    if (moved) position = placed.begin.to_world(local);
  }
}

/// Into how many equal legs the step is cut by what turns within `reach`: over a turn by a, the chord leaves an arc of
/// radius R by R a^2/8.
template <int Dim>
int count_legs(const Obstacles<Dim>& obstacles, const Vec<Dim>& position, double reach, double radius) {
  double legs = 1.0;
  for (const PlacedObstacle<Dim>& placed : obstacles) {
    if (!placed.turning() || placed.gone || placed.bvh.distance(placed.begin.to_rest(position), reach) >= reach)
      continue;
    legs = std::max(legs, std::ceil(skew_angle<Dim>(placed.turn) *
                                    std::sqrt((placed.reach + radius) / (0.8 * radius_at(placed, radius)))));
  }
  return static_cast<int>(legs);
}

template <int Dim>
Way<Dim> find_way(const Moving<Dim>& m, double leg_end, double dt) {
  const double duration = (leg_end - m.share) * dt;
  if (!m.carrier) return {m.position + duration * m.transport, Vec<Dim>::Zero()};
  const Pose<Dim> from = m.carrier->pose(m.share), to = m.carrier->pose(leg_end);
  const Vec<Dim> in_carrier = duration * (from.rotation.transpose() * m.relative);
  return {to.to_world(from.to_rest(m.position) + in_carrier), in_carrier};
}

/// Each obstacle sees the way in its own frame.
template <int Dim>
FirstHit<Dim> find_first_hit(const Obstacles<Dim>& obstacles, double radius, const Moving<Dim>& sphere,
                             const Way<Dim>& straight, double leg_end) {
  FirstHit<Dim> first;
  for (std::uint32_t o = 0; o < obstacles.size(); ++o) {
    const PlacedObstacle<Dim>& placed = obstacles[o];
    if (placed.gone) continue;
    const Vec<Dim> from = placed.pose(sphere.share).to_rest(sphere.position);
    const Vec<Dim> way =
        &placed == sphere.carrier ? straight.in_carrier : Vec<Dim>(placed.pose(leg_end).to_rest(straight.goal) - from);
    const auto hit = placed.bvh.first_contact(from, way, radius_at(placed, radius));
    if (hit && (!first.touched || hit->contact.time < first.time))
      first = {&placed, o, hit->contact.time, hit->contact.normal, from + hit->contact.time * way};
  }
  return first;
}

/// A velocity that a rigid body gives the sphere is to be paid for by the body.
template <int Dim>
void set_velocity(Moving<Dim>& m, const PlacedObstacle<Dim>& by, std::uint32_t obstacle, const Vec<Dim>& velocity) {
  if (by.body && m.hits) m.hits->push_back({obstacle, velocity - m.velocity, m.position});
  m.velocity = velocity;
}

/// Goes there; what goes with an obstacle that turns, turns with it.
template <int Dim>
void arrive(Moving<Dim>& m, const Vec<Dim>& position, double share) {
  if (m.carrier && m.carrier->turning()) {
    const Mat<Dim> turn = rotation_of<Dim>((share - m.share) * m.carrier->turn);
    const Vec<Dim>& with = m.carrier->twist.velocity;
    m.transport = with + turn * (m.transport - with);
    set_velocity<Dim>(m, *m.carrier, m.carrier_index, with + turn * (m.velocity - with));
    m.relative = turn * m.relative;
  }
  m.position = position;
  m.share = share;
}

/// The velocity after a hit; `velocity` is relative to the obstacle's surface.
template <int Dim>
Vec<Dim> respond(const Vec<Dim>& velocity, const Vec<Dim>& normal, const ContactResponse& response) {
  const double normal_speed = velocity.dot(normal);
  const Vec<Dim> tangential = velocity - normal_speed * normal;
  // What already moves away is left alone: the obstacle only pushes.
  return response.friction * tangential + (normal_speed < 0.0 ? -response.restitution : 1.0) * normal_speed * normal;
}

/// The sphere answers what it hit, and goes on in that frame.
template <int Dim>
void bounce(Moving<Dim>& m, const FirstHit<Dim>& hit) {
  const PlacedObstacle<Dim>& touched = *hit.touched;
  const Pose<Dim> pose = touched.pose(m.share);
  const Vec<Dim> normal = pose.rotation * hit.normal;
  // The twist is told about where the pivot ends.
  const Vec<Dim> place = m.position - pose.to_world(touched.pivot) + touched.twist.centre;
  const Vec<Dim> motion = touched.twist.at(place), slide = touched.velocity_at(place, normal) - motion;
  m.relative = slide + respond<Dim>(m.transport - motion - slide, normal, touched.obstacle.response);
  m.transport = motion + m.relative;
  set_velocity<Dim>(m, touched, hit.obstacle,
                    motion + slide + respond<Dim>(m.velocity - motion - slide, normal, touched.obstacle.response));
  m.carrier = &touched;
  m.carrier_index = hit.obstacle;
}

}  // namespace

template <int Dim>
Pose<Dim> PlacedObstacle<Dim>::pose(double s) const {
  if (s <= 0.0) return begin;
  if (s >= 1.0) return end;
  Pose<Dim> between;
  between.rotation = turning() ? Mat<Dim>(rotation_of<Dim>(s * turn) * begin.rotation) : begin.rotation;
  between.translation = (1.0 - s) * begin.to_world(pivot) + s * end.to_world(pivot) - between.rotation * pivot;
  return between;
}

namespace {

/// The rigid body of an obstacle with a mass, as it starts.
template <int Dim>
void make_body(PlacedObstacle<Dim>& placed) {
  const Motion<Dim>& motion = placed.obstacle.motion;
  CHECK(motion.keyframes.empty());
  RigidBody<Dim> body = make_rigid_body<Dim>(placed.bvh.simplices(), *placed.obstacle.mass);
  body.state.velocity = motion.velocity;
  const Mat<Dim> second = body.axes * body.moments.asDiagonal() * body.axes.transpose();
  body.state.angular_momentum = motion.spin * second + second * motion.spin;
  placed.pivot = body.rest_centre;
  placed.body = body;
  for (const auto& facet : placed.bvh.simplices())
    placed.corners.insert(placed.corners.end(), facet.begin(), facet.end());
  const auto before = [](const Vec<Dim>& a, const Vec<Dim>& b) {
    return std::lexicographical_compare(a.data(), a.data() + Dim, b.data(), b.data() + Dim);
  };
  std::sort(placed.corners.begin(), placed.corners.end(), before);
  placed.corners.erase(std::unique(placed.corners.begin(), placed.corners.end()), placed.corners.end());
}

}  // namespace

template <int Dim>
void Colliders<Dim>::add(Obstacle<Dim> obstacle) {
  SimplexBvh<Dim> bvh(std::move(obstacle.facets));
  obstacle.facets.clear();
  Placed placed{std::move(obstacle), std::move(bvh), {}, 0.0, {}, {}, {}, {}, Mat<Dim>::Zero(), {}, {}};
  placed.pivot = placed.obstacle.motion.pivot;
  if (placed.obstacle.mass) make_body(placed);
  for (const auto& facet : placed.bvh.simplices())
    for (const Vec<Dim>& corner : facet) placed.reach = std::max(placed.reach, (corner - placed.pivot).norm());
  has_bodies_ = has_bodies_ || placed.body;
  max_slide_ = std::max(max_slide_, placed.obstacle.surface_velocity.norm());
  max_girth_ = std::max(max_girth_, placed.obstacle.wall ? wall_guard : 1.0);
  placed_.push_back(std::move(placed));
}

template <int Dim>
bool Colliders<Dim>::has_walls() const {
  return std::any_of(placed_.begin(), placed_.end(), [](const Placed& p) { return p.obstacle.wall; });
}

template <int Dim>
double Colliders<Dim>::speed_bound(double begin, double end) const {
  double speed = 0.0;
  for (const Placed& p : placed_) {
    if (p.gone) continue;
    const double of_motion = p.body ? p.body->state.velocity.norm() + p.reach * skew_angle<Dim>(p.body->spin())
                                    : smelt::speed_bound<Dim>(p.obstacle.motion, begin, end, p.reach);
    speed = std::max(speed, of_motion + p.obstacle.surface_velocity.norm());
  }
  return speed;
}

template <int Dim>
void Colliders<Dim>::place_at(double time) {
  for (Placed& p : placed_) {
    p.gone = time >= p.obstacle.until;
    p.turn.setZero();
    if (p.body) {
      p.begin = p.end = p.body->pose();
      p.twist = {p.body->state.velocity, p.body->state.centre, p.body->spin()};
    }
    if (p.body || p.obstacle.motion.still()) continue;
    p.begin = p.end = pose_at(p.obstacle.motion, time);
    p.twist = twist_at(p.obstacle.motion, time);
    p.acceleration = acceleration_at(p.obstacle.motion, time);
  }
  step_way_ = 0.0;
}

template <int Dim>
double Colliders<Dim>::clearance(const Vec<Dim>& point, double limit) const {
  double distance = limit;
  for (const Placed& p : placed_)
    if (!p.gone) distance = std::min(distance, p.bvh.distance(p.begin.to_rest(point), distance));
  return distance;
}

template <int Dim>
void Colliders<Dim>::begin_step(double time, double dt) {
  step_end_ = time + dt;
  for (Placed& p : placed_) {
    if (p.gone || p.body || p.obstacle.motion.still()) continue;
    p.end = pose_at(p.obstacle.motion, time + dt);
    // A spin may go round more than half a turn.
    if (!p.obstacle.motion.spin.isZero(0.0))
      p.turn = dt * p.obstacle.motion.spin;
    else if (p.obstacle.motion.turns())
      p.turn = skew_of<Dim>(p.end.rotation * p.begin.rotation.transpose());
    const Vec<Dim> from = p.begin.to_world(p.pivot), to = p.end.to_world(p.pivot);
    p.twist = {(to - from) / dt, to, p.turn / dt};
    p.acceleration = acceleration_at(p.obstacle.motion, time + dt);
  }
  if (has_bodies_) move_bodies(placed_, dt);
  step_way_ = 0.0;
  for (const Placed& p : placed_)
    if (!p.gone && p.moving())
      step_way_ = std::max(
          step_way_, (p.end.to_world(p.pivot) - p.begin.to_world(p.pivot)).norm() + p.reach * skew_angle<Dim>(p.turn));
}

template <int Dim>
bool Colliders<Dim>::end_step() {
  bool vanished = false;
  for (Placed& p : placed_) {
    p.begin = p.end;
    p.turn.setZero();
    const bool gone = step_end_ >= p.obstacle.until;
    vanished = vanished || gone != p.gone;
    p.gone = gone;
    if (!p.body) continue;
    p.body->state.rotation = p.end.rotation;
    p.body->state.centre = p.end.to_world(p.pivot);
  }
  return vanished;
}

template <int Dim>
std::vector<BodyState<Dim>> Colliders<Dim>::body_states() const {
  std::vector<BodyState<Dim>> states;
  for (const Placed& p : placed_)
    if (p.body) states.push_back(p.body->state);
  return states;
}

template <int Dim>
void Colliders<Dim>::set_body_states(std::span<const BodyState<Dim>> states) {
  std::size_t k = 0;
  for (Placed& p : placed_)
    if (p.body) {
      CHECK_LT(k, states.size());
      p.body->state = states[k++];
    }
  CHECK_EQ(k, states.size());
}

template <int Dim>
void Colliders<Dim>::kick_bodies(const Vec<Dim>& gravity, double dt) {
  for (Placed& p : placed_)
    if (p.body && !p.gone) kick_body(*p.body, gravity, dt);
}

template <int Dim>
void Colliders<Dim>::set_body_loads(std::span<const Load<Dim>> loads) {
  CHECK_EQ(loads.size(), placed_.size());
  for (std::size_t k = 0; k < placed_.size(); ++k)
    if (placed_[k].body) placed_[k].body->load = loads[k];
}

template <int Dim>
bool Colliders<Dim>::move_sphere(double radius, double dt, Vec<Dim>& position, Vec<Dim>& transport, Vec<Dim>& velocity,
                                 std::vector<BodyHit<Dim>>* hits) const {
  // A response never lengthens the path relative to what was hit, and each obstacle comes nearer by its own way: twice
  // the longest, since it may be returned. Twice the radius: a sphere that starts inside an obstacle is first moved
  // out, by up to its radius.
  const double reach = 2.0 * radius + dt * (transport.norm() + 2.0 * max_slide_) + 3.0 * step_way_;
  const int n_legs = count_legs<Dim>(placed_, position, reach, radius);
  push_out<Dim>(placed_, radius, position);

  Moving<Dim> sphere{position, transport, velocity};
  sphere.hits = hits;
  int bounces = 0;
  for (int leg = 1; leg <= n_legs; ++leg) {
    const double leg_end = leg == n_legs ? 1.0 : static_cast<double>(leg) / n_legs;
    while (sphere.share < leg_end) {
      const Way<Dim> straight = find_way(sphere, leg_end, dt);
      // Only what moves can press a sphere flat. Past facets at rest, more bounces are a corner: there it waits, whole,
      // for the next step.
      const bool pressed = step_way_ > 0.0;
      const double girth = (pressed && bounces >= max_bounces ? squeezed : 1.0) * radius;
      const FirstHit<Dim> hit = find_first_hit<Dim>(placed_, girth, sphere, straight, leg_end);
      if (!hit.touched) {
        arrive<Dim>(sphere, straight.goal, leg_end);
        break;
      }
      const double share = sphere.share + hit.time * (leg_end - sphere.share);
      arrive<Dim>(sphere, hit.touched->pose(share).to_world(hit.place), share);
      if (bounces++ >= (pressed ? 2 : 1) * max_bounces)  // held fast from all sides: it goes with what it touched last
        arrive<Dim>(sphere, hit.touched->pose(leg_end).to_world(hit.place), leg_end);
      else
        bounce(sphere, hit);
    }
  }
  position = sphere.position;
  transport = sphere.transport;
  velocity = sphere.velocity;
  return bounces > 0;
}

template struct PlacedObstacle<1>;
template struct PlacedObstacle<2>;
template struct PlacedObstacle<3>;
template class Colliders<1>;
template class Colliders<2>;
template class Colliders<3>;

}  // namespace smelt
