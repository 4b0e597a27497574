#pragma once
// The whole stage: particles of a frame -> closed triangle mesh with normals, velocity and the scene's own fields.

#include "core/geometry/surface_mesh.h"
#include "core/sph/particle_frame.h"

namespace smelt {

/// How a surface is made. Lengths are ratios to the initial particle spacing, so one set of options suits every scale.
/// The defaults are measured in docs/decisions/0004-marching-cubes.md.
struct SurfacingOptions {
  double iso_value = 0.5;            ///< of chi, in (0, 1); 1 deep inside, 0 outside
  double cell_over_spacing = 0.5;    ///< edge of a grid cell / spacing, in (0, 1.5 kernel_over_spacing] and at most 4
  double kernel_over_spacing = 1.0;  ///< smoothing length h of chi's kernel / spacing, in [0.5, 4]; support radius 2 h
  /// 0: the bare chi of [P 5-7], in which drops, threads and thin sheets shrink or disappear. 1: particles of such
  /// features weigh more, so that they keep their volume (surfacing/thin_features.h). In [0, 2].
  double thin_feature_gain = 1.0;
  /// Kernels near the surface are flattened across it and stretched along it (surfacing/kernel_shapes.h).
  bool anisotropic = true;
  int smoothing_passes = 30;          ///< of the mesh, >= 0; 0 = none; keeps volumes (surfacing/smooth_mesh.h)
  double memory_limit_bytes = 8.0e9;  ///< refuse to start when the grid and its mesh would need more
};

/// Cells wider than so many kernels, cell_over_spacing / kernel_over_spacing, pass particles by.
constexpr double most_cell_over_kernel = 1.5;

/// The iso-surface of chi(x) = sum_j V_j W(x - x_j, h), V = m/rho  [P 5-7], by marching cubes
/// (surfacing/marching_cubes.h), then smoothed; a closed, outward oriented 2-manifold. Velocity, and temperature,
/// viscosity and rest position where `particles` has them, are SPH averages at the vertices. The grid stands still in
/// the world, so a resting fluid gives a resting mesh. Same input, same bytes, on any number of threads. An empty
/// surface where chi is below the iso-value at every sample, as of a drop with `thin_feature_gain` = 0.
///
/// Throws Error: no particles; a position that is not finite or too far out (2^20 edges of 2 h); a density or mass that
/// is not positive; another field that is not finite (all of them name the particle by its id, and the field); all of
/// several particles at one place; an option out of range; a surface that would need more than `memory_limit_bytes`
/// (says how much), or has more than 2^32/3 triangles.
SurfaceMesh build_surface(const ParticleFrame& particles, const SurfacingOptions& options);

}  // namespace smelt
