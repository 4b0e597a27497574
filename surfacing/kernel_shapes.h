#pragma once
// Kernels stretched along the surface and flattened across it: surfaces without blobs.

#include "surfacing/particle_bins.h"
#include "surfacing/surface_region.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace smelt {

/// The kernel of one particle, W_j(d) = weight W(q) with q^2 = d^T M d for d [m] from its centre; W(q) of
/// surfacing/kernel.h with h = 1. Its volume integral is that of the isotropic kernel of smoothing length h where
/// weight = sqrt(det M).
struct KernelShape {
  std::array<float, 6> m;      ///< M_xx, M_yy, M_zz, M_xy, M_xz, M_yz [1/m^2]
  std::array<float, 3> reach;  ///< half the extents of its support [m]
  std::array<float, 3> shift;  ///< of its centre from the particle [m]
  float weight;                ///< [1/m^3]
};

/// Shapes of the particles in the bins that have any: those of bin b begin at first[b], which is `isotropic` for others.
struct KernelShapes {
  static constexpr std::uint32_t isotropic = 0xffffffff;
  std::vector<std::uint32_t> first;  ///< one per bin; empty: all are isotropic
  std::vector<KernelShape> shape;
};

/// The shape of a ball of smoothing length h [m].
KernelShape isotropic_shape(double h);

/// Anisotropic kernels after [Yu & Turk 2013] of the particles near the surface; `volume` [m^3] in the order of `bins`.
KernelShapes compute_kernel_shapes(const ParticleBins& bins, const SurfaceRegion& region, double spacing, double h);

}  // namespace smelt
