#pragma once
// The corrected SPH gradient  [Bonet & Lok 1999].

#include "core/sph/particles.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace smelt {

/// Below this eigenvalue of the position moment (about 1 in the bulk, less at a surface) a particle has
/// too few neighbours along the eigenvector to tell a gradient: lone particles, threads across themselves, sheets
/// across theirs.
inline constexpr double smallest_trusted_moment = 0.1;

/// Whether all eigenvalues of the symmetric `m` exceed `least` (Sylvester's criterion for m - least).
template <int Dim>
bool eigenvalues_exceed(const Mat<Dim>& m, double least) {
  const double a = m(0, 0) - least;
  if constexpr (Dim == 1) {
    return a > 0.0;
  } else {
    const double b = m(1, 1) - least, ab = m(0, 1);
    const double minor = a * b - ab * ab;
    if constexpr (Dim == 2) {
      return a > 0.0 && minor > 0.0;
    } else {
      const double c = m(2, 2) - least, ac = m(0, 2), bc = m(1, 2);
      return a > 0.0 && minor > 0.0 && c * minor - bc * (a * bc - ab * ac) + ac * (ab * bc - b * ac) > 0.0;
    }
  }
}

/// L, the inverse of M = sum V_j (x_j - x_i) (x) grad_w_ij (symmetric, positive semi-definite), so that
/// grad f = [sum V_j (f_j - f_i) (x) grad_w_ij] L is exact for linear f. Along eigenvectors whose eigenvalue is below
/// smallest_trusted_moment the inverse falls off linearly to 0: no neighbours, no gradient, no force.
template <int Dim>
Mat<Dim> compute_gradient_correction(const Mat<Dim>& moment) {
  if (eigenvalues_exceed<Dim>(moment, smallest_trusted_moment)) return moment.inverse();
  const Eigen::SelfAdjointEigenSolver<Mat<Dim>> eigen(moment);
  Vec<Dim> inverse = eigen.eigenvalues();
  for (int k = 0; k < Dim; ++k) {
    constexpr double least = smallest_trusted_moment;
    inverse[k] = inverse[k] >= least ? 1.0 / inverse[k] : std::max(inverse[k], 0.0) / (least * least);
  }
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace smelt
