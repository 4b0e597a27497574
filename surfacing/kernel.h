#pragma once
// The cubic spline in three dimensions, as the field and the attributes use it: single precision, branchless.

#include "surfacing/float8.h"

#include <numbers>

namespace smelt {

/// h^3 W(r, h) of the cubic spline [S 4.16, d = 3] at q = r/h, for one float or eight; no unit, support q < 2, integral
/// over q-space 1. Written as a difference of two truncated cubes, which is the same polynomial and needs no branch: W
/// = ((2-q)_+^3 - 4 (1-q)_+^3) / (4 pi).
template <typename Real>
Real cubic_spline(Real q) {
  constexpr float scale = static_cast<float>(0.25 / std::numbers::pi);
  const Real outer = positive_part(2.0f - q), inner = positive_part(1.0f - q);
  return scale * (outer * outer * outer - 4.0f * (inner * inner * inner));
}

}  // namespace smelt
