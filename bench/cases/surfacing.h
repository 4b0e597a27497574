#pragma once
// How true surfaces are to what the particles fill: a ball, whose surface is known, and the bunny.

#include "bench/cases/case.h"
#include "core/geometry/simplex_bvh.h"
#include "core/sph/particle_frame.h"
#include "surfacing/surface.h"

namespace smelt::surfacing_cases {

/// Particles at rest of density 1000 kg/m^3.
ParticleFrame make_frame(std::vector<Vec3> position, double spacing);

/// Moves each particle by up to `most` spacings along every axis.
void jitter(ParticleFrame& frame, double most);

/// A ball about the origin of particles on a lattice that has no site there.
ParticleFrame make_ball(double radius, double spacing);

SurfacingOptions with_kernels(bool anisotropic);

std::vector<Simplex<3>> simplices(const TriangleMesh& mesh);

/// How far a surface is from the sphere.
struct BallErrors {
  double mean_radius = 0.0;  ///< of the vertices / radius - 1
  double farthest = 0.0;     ///< largest |distance from the middle / radius - 1| of a vertex
  double volume = 0.0;       ///< that of the surface / that of the particles - 1
  double normals = 0.0;      ///< angle to the radius [rad], root mean square
};
BallErrors measure_ball(const SurfaceMesh& surface, const ParticleFrame& frame, double radius);

/// Distances [m] from the vertices and the middles of the faces of a mesh to another, none taken for more than `limit`
/// [m]; the mean is weighted with area.
struct Distances {
  double largest = 0.0, mean = 0.0;
};
Distances distances(const TriangleMesh& from, const TriangleMesh& to, double limit);

Case make_sphere_case();
Case make_bunny_case();

}  // namespace smelt::surfacing_cases
