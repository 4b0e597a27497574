#pragma once
// Kernels flattened across the surface: flat surfaces without bumps, thin sheets and threads that stay thin.

#include "surfacing/particle_bins.h"
#include "surfacing/surface_region.h"

#include <array>
#include <cstdint>
#include <vector>

namespace smelt {

/// The kernel of one particle, W_j(d) = weight W(q) with q^2 = d^T M d for d [m] from its particle; W(q) of
/// surfacing/kernel.h with h = 1. Its volume integral is 1 where weight = sqrt(det M).
struct KernelShape {
  std::array<float, 6> m;      ///< M_xx, M_yy, M_zz, M_xy, M_xz, M_yz [1/m^2]
  std::array<float, 3> reach;  ///< half the extents of its support [m]
  float weight;                ///< [1/m^3]
};

/// Shapes of the particles in the bins that have any: those of bin b begin at first[b], which is `isotropic` for
/// others.
struct KernelShapes {
  static constexpr std::uint32_t isotropic = 0xffffffff;
  std::vector<std::uint32_t> first;  ///< one per bin
  std::vector<KernelShape> shape;
};

/// The shape of a ball of smoothing length h [m].
KernelShape isotropic_shape(double h);

/// Anisotropic kernels after [Yu & Turk 2013] for the particles near the surface: the weighted covariance of the
/// neighbours within R = 3 `spacing` [m], w = 1 - (r/R)^3, has axes e_k and variances l_k; M = sum_k e_k e_k^T / (h
/// s_k)^2 with s_k = (l_k / (0.15 R^2))^0.15, which is 1 in the bulk, 0.84 across a flat surface and 0.87 half a
/// spacing below it, held in [0.5, 1.15]. Departures from the text: a smaller power of the variance, at which a ball
/// has its volume; kernels keep their integral, but for a factor min(1, s_2/0.75) of the middle s, which is 1 but on
/// threads and gives those their volume; centres stay where they are, as moving them to the weighted means shrinks
/// everything by most of a spacing; and between 4 neighbours and 1 the kernel turns round continuously, so that nothing
/// pops.
KernelShapes compute_kernel_shapes(const ParticleBins& bins, const SurfaceRegion& region, double spacing, double h);

}  // namespace smelt
