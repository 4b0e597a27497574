#pragma once
// From particles to the vertices of their surface.

#include "core/geometry/surface_mesh.h"
#include "core/sph/particle_frame.h"
#include "surfacing/particle_bins.h"

#include <span>
#include <vector>

namespace smelt {

/// Overwrites velocity, and temperature, viscosity and rest position where `particles` has them, at each vertex x of
/// `surface.mesh` with the SPH average A(x) = sum_j V_j A_j W(x - x_j, h) / sum_j V_j W(x - x_j, h) (Shepard 1968):
/// exact for constants, always between the least and the greatest A_j. Where no particle is within 2 h of x, h is
/// doubled until one is: a vertex may lie farther out than any kernel reaches where the iso-value is low and cells are
/// wide. `bins` holds the positions of `particles`, at least one; `volume` [m^3] their V > 0 in the order of `bins`, h
/// in metres. Returns the same average of `extra` (in the order of `bins`).
std::vector<float> compute_attributes(SurfaceMesh& surface, const ParticleFrame& particles, const ParticleBins& bins,
                                      std::span<const float> volume, std::span<const float> extra, double h);

}  // namespace smelt
