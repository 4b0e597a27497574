#pragma once
// Collision of particles (spheres) with triangle meshes  [P 6.3, Algorithm 2].

#include "core/geometry/simplex_bvh.h"

#include <vector>

namespace smelt {

/// How an obstacle answers: after a hit v' = friction v_t - restitution v_n, both in [0, 1]; both 0 = no slip  [P 6.3.1].
struct ContactResponse {
  double friction = 0.0;     ///< share of the tangential velocity that is kept
  double restitution = 0.0;  ///< share of the normal velocity that is returned
};

/// Obstacles of one scene. Triangles are two-sided: a particle stays on the side it is on.
template <int Dim>
class Colliders {
 public:
  /// Adds the triangles (3D) or segments (2D) of one obstacle at rest.
  void add(std::vector<Simplex<Dim>> simplices, const ContactResponse& response);

  bool empty() const { return obstacles_.empty(); }

  /// Moves a sphere of radius `radius` [m] for `dt` [s] with `transport` velocity; at each hit the rest of the step goes on with the
  /// new velocity and may hit again, up to `max_bounces`, after which it stays at the last contact. A sphere that overlaps an
  /// obstacle at the start is first moved out to touch it. `velocity` [m/s] gets the same answers as `transport`. Returns
  /// whether anything was hit.
  bool move_sphere(double radius, double dt, Vec<Dim>& position, Vec<Dim>& transport, Vec<Dim>& velocity) const;

  static constexpr int max_bounces = 8;

 private:
  struct Obstacle {
    SimplexBvh<Dim> bvh;
    ContactResponse response;
  };
  std::vector<Obstacle> obstacles_;
};

}  // namespace smelt
