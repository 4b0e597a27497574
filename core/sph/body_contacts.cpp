#include "core/sph/body_contacts.h"

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

constexpr double skin_over_reach = 1e-3;
constexpr int n_passes = 4, n_sweeps = 30, n_stops = 20;

/// A corner of body `a` at a facet of obstacle `b`.
template <int Dim>
struct Contact {
  std::size_t a, b, corner;
  Vec<Dim> at;          ///< the corner [m]
  Vec<Dim> normal;      ///< towards the body
  double restitution;   ///< share of the impulse that stops it that is given back; of what does not approach, 0
  double target;        ///< least normal velocity while it is stopped, relative [m/s]
  Vec<Dim> slide;       ///< tangential velocity to end with, relative [m/s]
  bool slippery;        ///< without friction
  double pushed = 0.0;  ///< normal impulse so far [kg m/s]
  bool returned = false;
};

template <int Dim>
Vec<Dim> velocity_of(const PlacedObstacle<Dim>& placed, const Vec<Dim>& x, const Vec<Dim>& normal) {
  return placed.body ? placed.body->velocity_at(x) : placed.velocity_at(x, normal);
}

template <int Dim>
double compliance_of(const PlacedObstacle<Dim>& placed, const Vec<Dim>& x, const Vec<Dim>& n) {
  return placed.body ? placed.body->compliance(x, n) : 0.0;
}

/// Where a body's free flight takes it.
template <int Dim>
void set_end(PlacedObstacle<Dim>& placed, double dt) {
  const BodyState<Dim> after = drift_body(*placed.body, dt);
  placed.end = {after.rotation, after.centre - after.rotation * placed.pivot};
  placed.turn = skew_of<Dim>(after.rotation * placed.begin.rotation.transpose());
}

/// The first facet of `b` that a corner of `a` meets within a skin of `skin` on its way through the step, in b's frame.
template <int Dim>
std::optional<SweepContact<Dim>> sweep_corner(const PlacedObstacle<Dim>& a, const PlacedObstacle<Dim>& b,
                                              const Vec<Dim>& corner, double skin, Vec<Dim>& way) {
  const Vec<Dim> from = b.begin.to_rest(a.begin.to_world(corner));
  way = b.end.to_rest(a.end.to_world(corner)) - from;
  const auto first = b.bvh.first_contact(from, way, skin);
  return first ? std::optional(first->contact) : std::nullopt;
}

/// Whether a body can meet an obstacle at all in this step.
template <int Dim>
bool may_meet(const PlacedObstacle<Dim>& a, const PlacedObstacle<Dim>& b) {
  const Vec<Dim> centre = a.begin.to_world(a.pivot);
  const double way = (a.end.to_world(a.pivot) - centre).norm() + a.reach * skew_angle<Dim>(a.turn) +
                     (b.end.to_world(b.pivot) - b.begin.to_world(b.pivot)).norm() + b.reach * skew_angle<Dim>(b.turn);
  const double reach = a.reach * (1.0 + skin_over_reach) + way;
  return b.bvh.distance(b.begin.to_rest(centre), reach) < reach;
}

/// Adds what the corners of `a` meet of `b` and have not met before; returns whether anything was added.
template <int Dim>
bool find_contacts(const std::vector<PlacedObstacle<Dim>>& placed, std::size_t a, std::size_t b, double dt,
                   std::vector<Contact<Dim>>& contacts) {
  const PlacedObstacle<Dim>&body = placed[a], &other = placed[b];
  const double skin = skin_over_reach * body.reach;
  if (!may_meet(body, other)) return false;
  const std::size_t before = contacts.size();
  for (std::size_t k = 0; k < body.corners.size(); ++k) {
    Vec<Dim> way;
    const auto hit = sweep_corner(body, other, body.corners[k], skin, way);
    if (!hit) continue;
    const Vec<Dim> at = body.begin.to_world(body.corners[k]), normal = other.begin.rotation * hit->normal;
    const bool known = std::any_of(contacts.begin(), contacts.end(), [&](const Contact<Dim>& c) {
      return c.a == a && c.b == b && c.corner == k && c.normal.dot(normal) > 0.999;
    });
    if (known) continue;
    const double gap = hit->time * std::abs(way.dot(hit->normal));
    const ContactResponse &ours = body.obstacle.response, &theirs = other.obstacle.response;
    const Vec<Dim> relative = velocity_of(body, at, normal) - velocity_of(other, at, normal);
    const double approach = relative.dot(normal);
    const double restitution = approach < 0.0 ? std::max(ours.restitution, theirs.restitution) : 0.0;
    // What does not bounce comes to rest at the skin, not before.
    contacts.push_back({a, b, k, at, normal, restitution, restitution > 0.0 ? 0.0 : -gap / dt,
                        std::min(ours.friction, theirs.friction) * (relative - approach * normal),
                        std::min(ours.friction, theirs.friction) == 1.0});
  }
  return contacts.size() != before;
}

template <int Dim>
void push(std::vector<PlacedObstacle<Dim>>& placed, const Contact<Dim>& c, const Vec<Dim>& impulse) {
  placed[c.a].body->strike(c.at, impulse);
  if (placed[c.b].body) placed[c.b].body->strike(c.at, -impulse);
}

/// One sweep of impulses over all contacts, normal and then tangential.
template <int Dim>
void sweep_impulses(std::vector<PlacedObstacle<Dim>>& placed, std::vector<Contact<Dim>>& contacts) {
  const auto relative_velocity = [&](const Contact<Dim>& c) -> Vec<Dim> {
    return velocity_of(placed[c.a], c.at, c.normal) - velocity_of(placed[c.b], c.at, c.normal);
  };
  for (Contact<Dim>& c : contacts) {
    if (c.returned) continue;
    const double normal_speed = relative_velocity(c).dot(c.normal);
    const double compliance = compliance_of(placed[c.a], c.at, c.normal) + compliance_of(placed[c.b], c.at, c.normal);
    const double pushed = std::max(0.0, c.pushed + (c.target - normal_speed) / compliance);
    push<Dim>(placed, c, (pushed - c.pushed) * c.normal);
    c.pushed = pushed;
    if (pushed == 0.0) continue;
    const Vec<Dim> relative = relative_velocity(c);
    const Vec<Dim> tangential = relative - relative.dot(c.normal) * c.normal, excess = tangential - c.slide;
    const double speed = excess.norm();
    // Friction slows down and never speeds up; without any, the blow alone changes how they slide.
    if (c.slippery || excess.dot(tangential) <= 0.0) continue;
    const Vec<Dim> along = excess / speed;
    push<Dim>(placed, c,
              -speed / (compliance_of(placed[c.a], c.at, along) + compliance_of(placed[c.b], c.at, along)) * along);
  }
}

/// Gives back the impulses that stopped what bounces, by Poisson's hypothesis: with several contacts at once, returning
/// each one's normal velocity could gain energy, and this cannot.
template <int Dim>
void return_impulses(std::vector<PlacedObstacle<Dim>>& placed, std::vector<Contact<Dim>>& contacts) {
  for (Contact<Dim>& c : contacts) {
    if (c.returned || c.restitution == 0.0) continue;
    push<Dim>(placed, c, c.restitution * c.pushed * c.normal);
    c.returned = true;
  }
}

/// The share of the step after which a corner comes within half a skin of a facet: what the impulses have left.
template <int Dim>
double first_passage(const std::vector<PlacedObstacle<Dim>>& placed, std::size_t a, std::size_t b) {
  double share = 1.0;
  if (!may_meet(placed[a], placed[b])) return share;
  Vec<Dim> way;
  for (const Vec<Dim>& corner : placed[a].corners)
    if (const auto hit = sweep_corner(placed[a], placed[b], corner, 0.5 * skin_over_reach * placed[a].reach, way))
      share = std::min(share, hit->time);
  return share;
}

template <int Dim>
void stop_at(PlacedObstacle<Dim>& placed, double share) {
  if (share >= 1.0) return;
  const Pose<Dim> stopped = placed.pose(share);
  placed.end = stopped;
  placed.turn = share * placed.turn;
}

}  // namespace

template <int Dim>
void move_bodies(std::vector<PlacedObstacle<Dim>>& placed, double dt) {
  const auto for_each_pair = [&](const auto& visit) {
    for (std::size_t a = 0; a < placed.size(); ++a)
      for (std::size_t b = 0; b < placed.size(); ++b)
        if (placed[a].body && a != b && !placed[a].gone && !placed[b].gone) visit(a, b);
  };
  const auto set_ends = [&] {
    for (PlacedObstacle<Dim>& p : placed)
      if (p.body && !p.gone) set_end(p, dt);
  };
  set_ends();
  std::vector<Contact<Dim>> contacts;
  for (int pass = 0; pass < n_passes; ++pass) {
    bool more = false;
    for_each_pair([&](std::size_t a, std::size_t b) { more = find_contacts(placed, a, b, dt, contacts) || more; });
    if (!more) break;
    for (int k = 0; k < n_sweeps; ++k) sweep_impulses(placed, contacts);
    return_impulses(placed, contacts);
    set_ends();
  }
  // What the impulses have not held stops where it is: the pair that meets first, then the next. The way to an earlier
  // end of a body that turns is another one, so all are looked at again; what has found no end without a passage stays
  // where it began.
  for (int pass = 0; !contacts.empty() && pass <= n_stops; ++pass) {
    bool stopped = false;
    for_each_pair([&](std::size_t a, std::size_t b) {
      const double share = pass < n_stops ? first_passage(placed, a, b) : first_passage(placed, a, b) < 1.0 ? 0.0 : 1.0;
      if (share >= 1.0) return;
      stop_at(placed[a], share);
      if (placed[b].body) stop_at(placed[b], share);
      stopped = true;
    });
    if (!stopped) break;
  }
  for (PlacedObstacle<Dim>& p : placed) {
    if (!p.body || p.gone) continue;
    const Vec<Dim> from = p.begin.to_world(p.pivot), to = p.end.to_world(p.pivot);
    p.twist = {(to - from) / dt, to, p.turn / dt};
  }
}

template void move_bodies<1>(std::vector<PlacedObstacle<1>>&, double);
template void move_bodies<2>(std::vector<PlacedObstacle<2>>&, double);
template void move_bodies<3>(std::vector<PlacedObstacle<3>>&, double);

}  // namespace smelt
