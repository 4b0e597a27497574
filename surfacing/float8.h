#pragma once
// Eight floats in one register: AVX2 is the least a machine must have (docs/decisions/0002), and a plain loop over a
// kernel does not vectorise under the compiler flags of this project, as sqrt may set errno.

#include <cstring>
#include <immintrin.h>

namespace smelt {

/// Arithmetic and comparison operators work lane by lane, and with scalars (a GCC and Clang extension).
using Float8 = float __attribute__((vector_size(32)));

inline Float8 load8(const float* from) {
  Float8 v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
inline void store8(float* to, Float8 v) {
  std::memcpy(to, &v, sizeof v);
}
inline Float8 sqrt(Float8 v) {
  return static_cast<Float8>(_mm256_sqrt_ps(static_cast<__m256>(v)));
}
inline Float8 positive_part(Float8 v) {
  return v > 0.0f ? v : Float8{};
}
inline float positive_part(float v) {
  return v > 0.0f ? v : 0.0f;
}

/// Lanes added in order.
inline float sum_of_lanes(Float8 v) {
  float sum = 0.0f;
  for (int l = 0; l < 8; ++l) sum += v[l];
  return sum;
}

}  // namespace smelt
