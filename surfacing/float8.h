#pragma once
// Eight floats in one register: AVX2 is the least a machine must have (docs/decisions/0002). A plain loop over a kernel
// would not become this by itself: a compiler may not change the order of a sum of floats, and here the lanes fix it.

#include <array>
#include <bit>
#include <cstdint>
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

/// What comparisons of Float8 give: all bits of a lane set where it holds.
using Mask8 = std::int32_t __attribute__((vector_size(32)));

/// Bit l: lane l holds.
inline unsigned bits(Mask8 mask) {
  return static_cast<unsigned>(_mm256_movemask_ps(std::bit_cast<__m256>(mask)));
}
/// Holds in the lanes from n on.
inline Mask8 beyond(std::uint32_t n) {
  return Mask8{0, 1, 2, 3, 4, 5, 6, 7} >= static_cast<std::int32_t>(n < 8 ? n : 8);
}

/// The first n floats; 0 in the other lanes.
inline Float8 load_some(const float* from, std::uint32_t n) {
  return static_cast<Float8>(_mm256_maskload_ps(from, std::bit_cast<__m256i>(~beyond(n))));
}

/// The lanes that a mask selects, moved to the front in their order; what is in the others is not said.
struct Packing {
  alignas(32) std::array<std::array<std::int32_t, 8>, 256> lane{};
  constexpr Packing() {
    for (unsigned mask = 0; mask < 256; ++mask)
      for (int from = 0, to = 0; from < 8; ++from)
        if ((mask >> from & 1u) != 0) lane[mask][to++] = from;
  }
};
inline constexpr Packing packing;

inline Float8 pack(Float8 v, unsigned selected) {
  Mask8 lane;
  std::memcpy(&lane, &packing.lane[selected], sizeof lane);
  return static_cast<Float8>(_mm256_permutevar8x32_ps(static_cast<__m256>(v), std::bit_cast<__m256i>(lane)));
}

/// Lanes added in order.
inline float sum_of_lanes(Float8 v) {
  float sum = 0.0f;
  for (int l = 0; l < 8; ++l) sum += v[l];
  return sum;
}

}  // namespace smelt
