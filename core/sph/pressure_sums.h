#pragma once
// Passes over neighbour pairs that smooth the pressure of a fluid and continue it into walls; absent where a scene has
// neither walls nor density diffusion. Symbols as in core/sph/pair_sums.h.

#include "core/sph/pair_sums.h"

#include <cstdint>
#include <span>

namespace smelt {

/// The pressure's gradient before correction, and what corrects it.
template <int Dim, typename Real>
struct PressureGradientSums {
  std::array<Real, Dim> gradient;              ///< sum V_j (p_j - p_i) grad_w_ij [Pa/m]
  std::array<Real, Dim*(Dim + 1) / 2> moment;  ///< sum V_j (x_j - x_i) (x) grad_w_ij, packed
};

/// For the particles named, from motion and pressure in `fields`. `sums` has one entry for each of them.
template <int Dim, typename Real>
void compute_pressure_gradient_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, KernelType kernel,
                                    double smoothing_length, std::span<const std::int32_t> particles,
                                    PressureGradientSums<Dim, Real>* sums);

/// Numbers per particle in the array of gradients below: g [Pa/m] and p [Pa].
template <int Dim>
inline constexpr int gradient_stride = Dim + 1;

/// 2 sum V_j [p_j - p_i + (g_i + g_j)/2 . x_ij] x_ij.grad_w_ij / (r^2 + 0.01 h^2) [Pa/m^2], with the sign of a
/// Laplacian: a diffusion of pressure (and so density) on what its gradients g [Pa/m] do not explain, so that a linear
/// field, such as water's at rest, is left alone  [Antuono 2010]. `gradients`: gradient_stride numbers per record of
/// `fields`. `sums`: one entry for each of them.
template <int Dim, typename Real>
void compute_pressure_diffusion_sums(const PairFields<Dim, Real>& fields, const std::vector<Real>& gradients,
                                     const NeighbourLists& lists, KernelType kernel, double smoothing_length,
                                     std::size_t begin, std::size_t end, Real* sums);

}  // namespace smelt
