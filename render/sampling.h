#pragma once
// Random numbers without a state, well spread over the samples of a pixel and over its neighbours; and shapes drawn
// from them.

#include "core/geometry/vec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace smelt {

/// A point of the unit square [0, 1)^2.
struct Sample2 {
  float u = 0.0f;
  float v = 0.0f;
};

inline constexpr float pi_f = std::numbers::pi_v<float>;

/// A well-mixed 32-bit hash (Wellons' lowbias32, a bijection).
constexpr std::uint32_t hash_u32(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352dU;
  x ^= x >> 15;
  x *= 0x846ca68bU;
  x ^= x >> 16;
  return x;
}

constexpr std::uint32_t hash_combine(std::uint32_t a, std::uint32_t b) {
  return hash_u32(a ^ hash_u32(b + 0x9e3779b9U));
}

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
  x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
  x = ((x >> 4) & 0x0f0f0f0fU) | ((x & 0x0f0f0f0fU) << 4);
  x = ((x >> 8) & 0x00ff00ffU) | ((x & 0x00ff00ffU) << 8);
  return (x >> 16) | (x << 16);
}

/// Owen scrambling of a bit-reversed number: each bit is flipped by a hash of the bits below it [Burley 2020, listing
/// 2, with Vegdahl's constants].
constexpr std::uint32_t owen_scramble_reversed(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeaU;
  x += seed;
  x *= (seed >> 16) | 1U;
  x ^= x * 0x05526c56U;
  x ^= x * 0x53a22864U;
  return x;
}

/// Second dimension of the Sobol sequence, bit-reversed: the Pascal matrix modulo 2 applied to the index, as a product
/// of one factor per power of two [Ahmed 2024].
constexpr std::uint32_t pascal_transform(std::uint32_t x) {
  x ^= x >> 16;
  x ^= (x & 0xff00ff00U) >> 8;
  x ^= (x & 0xf0f0f0f0U) >> 4;
  x ^= (x & 0xccccccccU) >> 2;
  x ^= (x & 0xaaaaaaaaU) >> 1;
  return x;
}

/// Interleaves the lower 16 bits of x and y: neighbours in the plane get near numbers.
constexpr std::uint32_t morton_code(std::uint32_t x, std::uint32_t y) {
  auto spread = [](std::uint32_t v) {
    v &= 0xffffU;
    v = (v | (v << 8)) & 0x00ff00ffU;
    v = (v | (v << 4)) & 0x0f0f0f0fU;
    v = (v | (v << 2)) & 0x33333333U;
    return (v | (v << 1)) & 0x55555555U;
  };
  return spread(x) | (spread(y) << 1);
}

inline float unit_float(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * 0x1p-24f;
}

/// The numbers of one sample of one pixel. Every aligned square of 2^k pixels shares one scrambled Sobol (0,2)-net per
/// pair of dimensions, so that errors cancel between neighbours [Ahmed and Wonka 2020]; pairs are independent of each
/// other.
class PixelSampler {
 public:
  /// `n_samples` (a power of two spreads best) are taken at this pixel, of which this is number `sample`.
  PixelSampler(int x, int y, int sample, int n_samples, std::uint32_t seed)
      : index_((morton_code(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y))
                << std::countr_zero(std::bit_ceil(static_cast<std::uint32_t>(n_samples)))) +
               static_cast<std::uint32_t>(sample)),
        seed_(seed) {}

  /// The pair of numbers for one purpose (`dimension`).
  Sample2 draw(std::uint32_t dimension) const {
    const std::uint32_t seed = hash_combine(seed_, dimension);
    // Shuffling keeps aligned blocks of indices together, hence the nets; it makes the dimensions independent.
    const std::uint32_t i = reverse_bits(owen_scramble_reversed(reverse_bits(index_), seed));
    const std::uint32_t u = owen_scramble_reversed(i, hash_u32(seed ^ 0x68bc21ebU));
    const std::uint32_t v = owen_scramble_reversed(pascal_transform(i), hash_u32(seed ^ 0x02e5be93U));
    return {unit_float(reverse_bits(u)), unit_float(reverse_bits(v))};
  }

 private:
  std::uint32_t index_;
  std::uint32_t seed_;
};

/// A right-handed frame around a unit vector [Duff 2017].
struct Frame {
  Vec3f tangent, bitangent, normal;

  explicit Frame(const Vec3f& n) : normal(n) {
    const float sign = std::copysign(1.0f, n.z());
    const float a = -1.0f / (sign + n.z());
    const float b = n.x() * n.y() * a;
    tangent = {1.0f + sign * n.x() * n.x() * a, sign * b, -sign * n.x()};
    bitangent = {b, sign + n.y() * n.y() * a, -n.y()};
  }
  Vec3f to_world(const Vec3f& v) const { return tangent * v.x() + bitangent * v.y() + normal * v.z(); }
  Vec3f to_local(const Vec3f& v) const { return {tangent.dot(v), bitangent.dot(v), normal.dot(v)}; }
};

/// Uniform on the unit disk, squares to squares [Shirley and Chiu 1997].
inline Sample2 sample_disk(Sample2 s) {
  const float a = 2.0f * s.u - 1.0f;
  const float b = 2.0f * s.v - 1.0f;
  if (a == 0.0f && b == 0.0f) return {0.0f, 0.0f};
  const bool wide = std::abs(a) > std::abs(b);
  const float r = wide ? a : b;
  const float angle = wide ? pi_f / 4.0f * (b / a) : pi_f / 2.0f - pi_f / 4.0f * (a / b);
  return {r * std::cos(angle), r * std::sin(angle)};
}

/// A direction around +z with density cos(theta)/pi [1/sr].
inline Vec3f sample_cosine_hemisphere(Sample2 s) {
  const Sample2 d = sample_disk(s);
  return {d.u, d.v, std::sqrt(std::max(0.0f, 1.0f - d.u * d.u - d.v * d.v))};
}

/// Distance r [m] drawn from the normalised diffusion profile R(r) 2 pi r = (e^(-r/d) + e^(-r/3d)) / 4d, as an equal
/// share of each exponential's own density (1/4 and 3/4) [Christensen and Burley 2015, eq. 3]. `d` > 0 in metres.
inline float sample_diffusion_radius(float u, float d) {
  const bool narrow = u < 0.25f;
  const float v = narrow ? 4.0f * u : (u - 0.25f) / 0.75f;
  return -(narrow ? d : 3.0f * d) * std::log(std::max(1.0f - v, 1e-6f));
}

}  // namespace smelt
