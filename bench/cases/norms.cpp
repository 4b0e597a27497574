#include "bench/cases/norms.h"

#include "core/error.h"

#include <cmath>

namespace smelt {

Norms compute_norms(std::span<const double> differences) {
  CHECK(!differences.empty());
  Norms norms;
  for (const double e : differences) {
    norms.l1 += std::abs(e);
    norms.l2 += e * e;
    if (!std::isnan(norms.max) && !(std::abs(e) <= norms.max)) norms.max = std::abs(e);  // a NaN stays one
  }
  norms.l1 /= static_cast<double>(differences.size());
  norms.l2 = std::sqrt(norms.l2 / static_cast<double>(differences.size()));
  return norms;
}

double convergence_order(std::span<const double> spacing, std::span<const double> error) {
  CHECK_EQ(spacing.size(), error.size());
  CHECK_GE(spacing.size(), 2u);
  const auto n = static_cast<double>(spacing.size());
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t k = 0; k < spacing.size(); ++k) {
    CHECK_GT(spacing[k], 0.0);
    CHECK_GT(error[k], 0.0);
    const double log_spacing = std::log(spacing[k]), log_error = std::log(error[k]);
    x += log_spacing;
    y += log_error;
    xx += log_spacing * log_spacing;
    xy += log_spacing * log_error;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace smelt
