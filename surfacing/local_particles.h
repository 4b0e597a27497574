#pragma once
// Kernel sums over the particles around a group of points, in single precision and eight lanes at a time.

#include "surfacing/kernel.h"
#include "surfacing/particle_bins.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace smelt {

/// The particles that can reach any point of a box, as arrays: position relative to `origin` in units of h, volume, and
/// N fields. Padded to whole lanes with particles of no volume.
template <std::size_t N>
struct LocalParticles {
  static constexpr std::size_t lanes = 8;

  Vec3 origin = Vec3::Zero();
  double h = 0.0;
  std::array<std::vector<float>, 3> x;
  std::vector<float> volume;
  std::array<std::vector<float>, N> field;

  std::size_t size() const { return volume.size(); }
  void clear() {
    for (auto& a : x) a.clear();
    for (auto& a : field) a.clear();
    volume.clear();
  }
  void add(const Vec3f& at, float v, const std::array<float, N>& values) {
    for (int a = 0; a < 3; ++a) x[a].push_back(at[a]);
    for (std::size_t f = 0; f < N; ++f) field[f].push_back(values[f]);
    volume.push_back(v);
  }
};

/// Overwrites `out` with the particles within 2 h of `box` [m]; `fields_of(j)` gives the fields of sorted particle j.
template <std::size_t N, typename FieldsOf>
void gather_particles(LocalParticles<N>& out, const ParticleBins& bins, std::span<const float> volume, const Box3& box,
                      double h, FieldsOf&& fields_of) {
  out.clear();
  out.origin = box.lower;
  out.h = h;
  const Vec3 low = box.lower.array() - 2.0 * h, high = box.upper.array() + 2.0 * h;
  for_each_range(bins, low, high, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t j = begin; j < end; ++j) {
      const Vec3& x = bins.position[j];
      if ((x.array() <= low.array()).any() || (x.array() >= high.array()).any()) continue;
      out.add(((x - out.origin) / h).template cast<float>(), volume[j], fields_of(j));
    }
  });
  while (out.size() % LocalParticles<N>::lanes != 0) out.add(Vec3f::Zero(), 0.0f, {});
}

/// A register as a struct, so that arrays of it keep its alignment.
struct Lanes {
  Float8 value{};
};

/// h^3 sum_j V_j W(x - x_j, h), then h^3 sum_j V_j A_j W for each field A. Each lane sums on its own, then the lanes
/// are added in order: the same bytes wherever the arrays lie in memory.
template <std::size_t N>
std::array<float, 1 + N> sum_at(const LocalParticles<N>& near, const Vec3& point) {
  const Vec3f at = ((point - near.origin) / near.h).template cast<float>();
  std::array<Lanes, 1 + N> sum{};
  for (std::size_t j = 0; j < near.size(); j += LocalParticles<N>::lanes) {
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

}  // namespace smelt
