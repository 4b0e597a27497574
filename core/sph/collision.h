#pragma once
// Collision of particles (spheres) with triangle meshes  [P 6.3, Algorithm 2].

#include "core/geometry/simplex_bvh.h"

#include <optional>
#include <vector>

namespace smelt {

/// How an obstacle answers: after a hit v' = friction v_t - restitution v_n, both in [0, 1]; both 0 = no slip  [P 6.3.1].
struct ContactResponse {
  double friction = 0.0;     ///< share of the tangential velocity that is kept
  double restitution = 0.0;  ///< share of the normal velocity that is returned
};

/// What particles meet. As a wall (core/sph/walls.h) it also takes part in density, pressure, shear and heat of the fluid near it.
template <int Dim>
struct Obstacle {
  std::vector<Simplex<Dim>> facets;  ///< where it is at the start [m]
  ContactResponse response = {};
  bool wall = false;
  /// The facets bound a solid, wound outward; otherwise they are a sheet, and what lies behind it is solid to either side.
  bool closed = false;
  Vec<Dim> velocity = Vec<Dim>::Zero();          ///< it moves with [m/s]
  Vec<Dim> surface_velocity = Vec<Dim>::Zero();  ///< of its surface beyond that, as of a belt or a lid: its part along the surface [m/s]
  std::optional<double> temperature = std::nullopt;  ///< [K]; absent: no heat passes

  /// Of the material at a place of the surface with unit normal `normal` [m/s].
  Vec<Dim> velocity_at(const Vec<Dim>& normal) const { return velocity + surface_velocity - surface_velocity.dot(normal) * normal; }
};

/// Obstacles of one scene. Facets are two-sided to a swept particle: it stays on the side it is on.
template <int Dim>
class Colliders {
 public:
  /// Facets without area hold nothing off and are no error.
  void add(Obstacle<Dim> obstacle);

  bool empty() const { return placed_.empty(); }
  bool has_walls() const;
  double max_speed() const;          ///< of obstacles that move and surfaces that slide [m/s]
  double max_obstacle_speed() const;  ///< of obstacles that move alone [m/s]

  /// Puts obstacles with velocities where they are at `time` [s].
  void place_at(double time);

  /// Moves a sphere of radius `radius` [m] for `dt` [s] with `transport` velocity; at each hit the rest of the step goes on with the
  /// new velocity and may hit again, up to `max_bounces`, after which it stays at the last contact, carried by that obstacle. A sphere that overlaps an
  /// obstacle at the start is first moved out to touch it. `velocity` [m/s] gets the same answers as `transport`. Obstacles that move
  /// do so meanwhile, from where place_at() put them. A wall holds fluid off by its pressure: there the sphere is but a guard, of
  /// `wall_guard` times the radius. Returns whether anything was hit.
  bool move_sphere(double radius, double dt, Vec<Dim>& position, Vec<Dim>& transport, Vec<Dim>& velocity) const;

  static constexpr int max_bounces = 8;
  static constexpr double wall_guard = 0.4;  ///< a quarter of the spacing in 3D

  /// An obstacle where it is now: facets are the BVH's, moved by `displacement`.
  struct Placed {
    Obstacle<Dim> obstacle;  ///< its facets live in the BVH
    SimplexBvh<Dim> bvh;
    Vec<Dim> displacement = Vec<Dim>::Zero();  ///< since the start [m]
  };
  const std::vector<Placed>& placed() const { return placed_; }

 private:
  std::vector<Placed> placed_;
};

}  // namespace smelt
