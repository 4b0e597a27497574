#pragma once
// How far off, and how fast that falls.

#include <span>

namespace smelt {

/// Unweighted norms of differences e_1 .. e_n: sum |e|/n, sqrt(sum e^2/n), max |e|. Throws InternalError where there
/// are none.
struct Norms {
  double l1 = 0.0;
  double l2 = 0.0;
  double max = 0.0;
};
Norms compute_norms(std::span<const double> differences);

/// p of error = C spacing^p, by least squares in the logarithms. Throws InternalError for fewer than two values or ones
/// <= 0.
double convergence_order(std::span<const double> spacing, std::span<const double> error);

}  // namespace smelt
