#pragma once
// Kernel sums over the particles around a group of points, in single precision and eight lanes at a time.

#include "surfacing/kernel.h"
#include "surfacing/particle_bins.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace smelt {

/// A register as a struct, so that arrays of it keep its alignment.
struct Lanes {
  Float8 value{};
};

/// The particles that can reach any point of a box, as arrays: position relative to `origin` in units of h, volume, and
/// N fields. Padded to whole lanes with particles of no volume.
template <std::size_t N>
struct LocalParticles {
  static constexpr std::size_t lanes = 8;

  Vec3 origin = Vec3::Zero();
  double h = 0.0;
  std::size_t size = 0;  ///< a multiple of `lanes`; the arrays may be longer
  std::array<std::vector<float>, 3> x;
  std::vector<float> volume;
  std::array<std::vector<float>, N> field;

  /// Makes room for n particles, and a register behind them.
  void reserve(std::size_t n) {
    n += lanes;
    if (volume.size() >= n) return;
    for (auto& a : x) a.resize(2 * n);
    for (auto& a : field) a.resize(2 * n);
    volume.resize(2 * n);
  }
};

/// Overwrites `out` with the particles within 2 h of `box` [m]; `fields_of(j)` gives the fields of sorted particle j.
template <std::size_t N, typename FieldsOf>
void gather_particles(LocalParticles<N>& out, const ParticleBins& bins, std::span<const float> volume, const Box3& box,
                      double h, FieldsOf&& fields_of) {
  constexpr std::size_t lanes = LocalParticles<N>::lanes;
  out.origin = box.lower;
  out.h = h;
  const auto h_per_edge = static_cast<float>(bins.edge / h);
  const Vec3f upper = (box.extent() / h).template cast<float>().array() + 2.0f;
  std::size_t n = 0;
  for_each_bin(bins, box.lower.array() - 2.0 * h, box.upper.array() + 2.0 * h, [&](std::size_t bin) {
    const Vec3f corner = ((bins.origin(bin) - out.origin) / h).template cast<float>();
    const std::uint32_t begin = bins.begin[bin], end = bins.begin[bin + 1];
    out.reserve(n + end - begin);
    for (std::uint32_t first = begin; first < end; first += lanes) {
      std::array<Lanes, 3> x;
      Mask8 far = beyond(end - first);
      for (int a = 0; a < 3; ++a) {
        x[a].value = corner[a] + h_per_edge * load8(&bins.offset[a][first]);
        far |= (x[a].value <= -2.0f) | (x[a].value >= upper[a]);
      }
      const unsigned near = ~bits(far) & 0xffu;
      for (int a = 0; a < 3; ++a) store8(&out.x[a][n], pack(x[a].value, near));
      store8(&out.volume[n], pack(load_some(&volume[first], end - first), near));
      if constexpr (N > 0) {
        std::size_t to = n;
        for (unsigned rest = near; rest != 0; rest &= rest - 1, ++to) {
          const auto values = fields_of(first + static_cast<std::uint32_t>(std::countr_zero(rest)));
          for (std::size_t f = 0; f < N; ++f) out.field[f][to] = values[f];
        }
      }
      n += static_cast<std::size_t>(std::popcount(near));
    }
  });
  out.reserve(n);
  out.size = (n + lanes - 1) / lanes * lanes;
  for (std::size_t i = n; i < out.size; ++i) {
    out.volume[i] = 0.0f;
    for (auto& a : out.x) a[i] = 0.0f;
    for (auto& a : out.field) a[i] = 0.0f;
  }
}

/// h^3 sum_j V_j W(x - x_j, h), then h^3 sum_j V_j A_j W for each field A, at a point given relative to near.origin in
/// units of h. Each lane sums on its own, then the lanes are added in order: the same bytes wherever the arrays lie in
/// memory.
template <std::size_t N>
std::array<float, 1 + N> sum_at(const LocalParticles<N>& near, const Vec3f& at) {
  std::array<Lanes, 1 + N> sum{};
  for (std::size_t j = 0; j < near.size; j += LocalParticles<N>::lanes) {
    const Float8 dx = load8(&near.x[0][j]) - at[0], dy = load8(&near.x[1][j]) - at[1],
                 dz = load8(&near.x[2][j]) - at[2];
    const Float8 weight = load8(&near.volume[j]) * cubic_spline(sqrt(dx * dx + dy * dy + dz * dz));
    sum[0].value += weight;
    for (std::size_t f = 0; f < N; ++f) sum[1 + f].value += weight * load8(&near.field[f][j]);
  }
  std::array<float, 1 + N> total{};
  for (std::size_t f = 0; f < 1 + N; ++f) total[f] = sum_of_lanes(sum[f].value);
  return total;
}

template <std::size_t N>
std::array<float, 1 + N> sum_at(const LocalParticles<N>& near, const Vec3& point) {
  return sum_at(near, Vec3f(((point - near.origin) / near.h).template cast<float>()));
}

}  // namespace smelt
