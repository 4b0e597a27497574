#pragma once
// Collision of particles (spheres) with triangle meshes  [P 6.3, Algorithm 2], at rest or moving rigidly.

#include "core/geometry/motion.h"
#include "core/geometry/simplex_bvh.h"
#include "core/sph/rigid_body.h"

#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace smelt {

/// How an obstacle answers: after a hit v' = friction v_t - restitution v_n, both in [0, 1]; both 0 = no slip  [P
/// 6.3.1].
struct ContactResponse {
  double friction = 0.0;     ///< share of the tangential velocity that is kept
  double restitution = 0.0;  ///< share of the normal velocity that is returned
};

/// What particles meet. As a wall (core/sph/walls.h) it also takes part in density, pressure, shear and heat of the
/// fluid near it.
template <int Dim>
struct Obstacle {
  std::vector<Simplex<Dim>> facets;  ///< at rest, before its motion moves it [m]
  ContactResponse response = {};
  bool wall = false;
  /// The facets bound a solid, wound outward; otherwise they are a sheet, and what lies behind it is solid to either
  /// side.
  bool closed = false;
  Motion<Dim> motion = {};
  /// Of its surface beyond that, as of a belt or a lid: its part along the surface [m/s]. It turns with the obstacle.
  Vec<Dim> surface_velocity = Vec<Dim>::Zero();
  std::optional<double> temperature = std::nullopt;        ///< [K]; absent: no heat passes
  double until = std::numeric_limits<double>::infinity();  ///< it vanishes then [s]
  /// [kg]: a rigid body, which goes where it is pushed; its motion says but velocity and spin at the start. Its facets
  /// must be closed.
  std::optional<double> mass = std::nullopt;
};

/// An obstacle where it is now. Its facets stay at rest in the BVH: queries are taken to where it is at rest instead.
template <int Dim>
struct PlacedObstacle {
  Obstacle<Dim> obstacle;  ///< its facets live in the BVH
  SimplexBvh<Dim> bvh;
  Vec<Dim> pivot = Vec<Dim>::Zero();   ///< it turns about, at rest [m]
  double reach = 0.0;                  ///< of the farthest corner from the pivot [m]
  std::optional<RigidBody<Dim>> body;  ///< what has a mass; its pivot is the centre of mass
  std::vector<Vec<Dim>> corners;       ///< of a body, each once, at rest [m]

  // The step being made, or none: then begin and end are the same.
  Pose<Dim> begin, end;
  Mat<Dim> turn = Mat<Dim>::Zero();  ///< skew [rad]: end.rotation = exp(turn) begin.rotation
  Twist<Dim> twist;  ///< the mean one of the step, about where the pivot ends; at rest in time, the motion's own
  RigidAcceleration<Dim> acceleration;
  bool gone = false;  ///< it has vanished

  bool turning() const { return !turn.isZero(0.0); }
  bool moving() const { return turning() || begin.translation != end.translation; }

  /// After the share `s` of the step.
  Pose<Dim> pose(double s) const;

  /// The motion and the sliding of the surface at a place of it with unit normal `normal` [m/s].
  Vec<Dim> velocity_at(const Vec<Dim>& x, const Vec<Dim>& normal) const {
    const Vec<Dim> slide = begin.rotation * obstacle.surface_velocity;
    return twist.at(x) + slide - slide.dot(normal) * normal;
  }
};

/// What a particle got of a rigid body that was taken for infinitely heavy.
template <int Dim>
struct BodyHit {
  std::uint32_t obstacle;
  Vec<Dim> gain;   ///< of the particle's velocity [m/s]
  Vec<Dim> place;  ///< of its centre [m]
};

/// Obstacles of one scene. Facets are two-sided to a swept particle: it stays on the side it is on.
template <int Dim>
class Colliders {
 public:
  using Placed = PlacedObstacle<Dim>;

  /// Facets without area are no error: they hold off as the edges that they are, and add nothing to a wall.
  void add(Obstacle<Dim> obstacle);

  bool empty() const { return placed_.empty(); }
  bool has_walls() const;
  bool has_bodies() const { return has_bodies_; }
  const std::vector<Placed>& placed() const { return placed_; }

  /// At least the speed [m/s] of any point of an obstacle that has not vanished, with the sliding of its surface,
  /// between `begin` and `end` [s].
  double speed_bound(double begin, double end) const;

  /// Puts every obstacle where it is at `time` [s], rigid bodies where their states have them, and takes away those
  /// that have vanished.
  void place_at(double time);

  /// Begins the step from `time`, at which everything was placed, to `time` + `dt` [s]: from now on move_sphere() meets
  /// what moves.
  void begin_step(double time, double dt);

  /// Ends it: everything is where it has moved to. Returns whether an obstacle vanished.
  bool end_step();

  /// The states of the rigid bodies, in the order of their obstacles, and how to go on from them.
  std::vector<BodyState<Dim>> body_states() const;
  void set_body_states(std::span<const BodyState<Dim>> states);

  /// Half a kick of every rigid body by its load and gravity [m/s^2].
  void kick_bodies(const Vec<Dim>& gravity, double dt);

  /// What the fluid does to the bodies, one load an obstacle.
  void set_body_loads(std::span<const Load<Dim>> loads);

  /// An impulse [kg m/s] at x on the body of an obstacle.
  void strike_body(std::size_t obstacle, const Vec<Dim>& x, const Vec<Dim>& impulse) {
    placed_[obstacle].body->strike(x, impulse);
  }

  /// The farthest that any point of an obstacle moves in this step, at most [m].
  double step_way() const { return step_way_; }

  /// Moves a sphere of radius `radius` [m] with `transport` velocity for the step of `dt` [s] that has begun; at each
  /// hit it goes on with the new velocity, in the frame of what it hit, and may hit again, up to `max_bounces`. Then,
  /// where obstacles move, the sphere gives in: it goes on as one of a thousandth of the radius (`squeezed`), so that
  /// it is pressed flat before it changes sides. A sphere that overlaps an obstacle at the start is first moved out to
  /// touch it. `velocity` [m/s] gets the same answers as `transport`. A wall holds fluid off by its pressure: there the
  /// sphere is but a guard, of `wall_guard` times the radius. Returns whether anything was hit.
  ///
  /// Relative to an obstacle that turns, a straight way is curved. It is taken along chords, whose ends are exact; they
  /// are so short that they leave it by no more than a tenth of the guard. So a sphere changes sides at no speed. Hits
  /// of rigid bodies are appended to `hits`, where given.
  bool move_sphere(double radius, double dt, Vec<Dim>& position, Vec<Dim>& transport, Vec<Dim>& velocity,
                   std::vector<BodyHit<Dim>>* hits = nullptr) const;

  /// Farther than this from all obstacles nothing is touched, and move_sphere() is a plain position += dt transport
  /// [m].
  double reach(double radius, double dt, const Vec<Dim>& transport) const {
    return max_girth_ * radius + dt * transport.norm() + step_way_;
  }

  /// From `point` to the nearest obstacle where the step begins [m], at most `limit`.
  double clearance(const Vec<Dim>& point, double limit) const;

  static constexpr int max_bounces = 8;
  static constexpr double wall_guard = 0.4;  ///< a quarter of the spacing in 3D
  static constexpr double squeezed = 1e-3;

 private:
  std::vector<Placed> placed_;
  double max_slide_ = 0.0;  ///< fastest surface_velocity [m/s]
  double step_way_ = 0.0;
  double step_end_ = 0.0;   ///< [s]
  double max_girth_ = 0.0;  ///< of spheres at any obstacle, in radii
  bool has_bodies_ = false;
};

}  // namespace smelt
