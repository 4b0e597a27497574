#pragma once

#include <cmath>

namespace smelt {

/// A bound from below in single precision: not above `x`, and nearer to it than 2^-22 of it; x finite.
inline float round_down(double x) {
  return static_cast<float>(x - std::abs(x) * 0x1p-23);
}

}  // namespace smelt
