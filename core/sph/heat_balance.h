#pragma once
// Pair weights that conduct heat at the right rate on any lattice (docs/decisions/0013-heat-balance.md).
//
// The pairwise Laplacian 2 sum V_j F (f_i - f_j) of [P 6-9] gives 2 sum V_j F x_ij = D for f = x, where it should give
// 0, and theta times too much for f = r^2, with theta the moment trace. Weights F b_ij (1/theta_i + 1/theta_j)/2 with
// b_ij = 1 + x_ij.(lambda_i - lambda_j), the same from both of a pair's ends, keep the energy to rounding. lambda makes
// sum V_j F b_ij x_ij vanish: lambda_i = L_i sum V_j F x_ij (1 - x_ij.lambda_j), one Jacobi sweep a step.

#include "core/sph/pair_sums.h"

#include <algorithm>

namespace smelt {

/// Of one particle, from the last pass over pairs.
template <int Dim, typename Real>
struct HeatBalance {
  Real moment_trace = 1;  ///< theta, not below `least_moment_trace` [-]
  Eigen::Matrix<Real, Dim, 1> lambda = Eigen::Matrix<Real, Dim, 1>::Zero();  ///< [1/m]
};

/// Heat between particles with fewer neighbours than one at an edge of a block has is not scaled up further: two that
/// nearly coincide would exchange it without bound.
inline constexpr double least_moment_trace = 0.25;

/// The next sweep, with the gradient correction L. Where the support is not full, at a free surface or an insulating
/// wall, the sum of x_ij is no error: lambda fades to 0 as theta falls from 0.9 to 0.8.
template <int Dim, typename Real>
HeatBalance<Dim, Real> balance_heat(const RateSums<Dim, Real>& sums, const Mat<Dim>& correction) {
  HeatBalance<Dim, Real> balance;
  const double full = std::clamp((static_cast<double>(sums.moment_trace) - 0.8) / 0.1, 0.0, 1.0);
  balance.moment_trace = std::max(sums.moment_trace, static_cast<Real>(least_moment_trace));
  if (full == 0.0) return balance;
  Vec<Dim> imbalance;
  for (int a = 0; a < Dim; ++a) imbalance[a] = sums.heat_imbalance[a];
  balance.lambda = (full * (correction * imbalance)).template cast<Real>();
  return balance;
}

}  // namespace smelt
