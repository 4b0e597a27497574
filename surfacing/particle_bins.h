#pragma once
// Particles sorted into the occupied cubes of a lattice: the one structure behind every "who is near here".

#include "core/geometry/vec.h"
#include "surfacing/lattice.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace smelt {

/// Bin b holds the sorted particles begin[b] .. begin[b + 1] - 1. Bins ascend by key; within a bin particles keep the
/// order of the input, so every sum over a bin runs in a fixed order.
struct ParticleBins {
  double edge = 0.0;                 ///< of a bin [m]; bin (i, j, k) spans [i, i + 1) * edge and so on
  std::vector<std::uint64_t> key;    ///< lattice_key of each occupied bin
  std::vector<std::uint32_t> begin;  ///< one more than there are bins
  std::vector<std::uint32_t> index;  ///< sorted particle -> particle of the input
  /// From the lower corner of its bin [edges], in [0, 1], in sorted order; 8 more behind them, so that a register may
  /// be loaded anywhere.
  std::array<std::vector<float>, 3> offset;

  std::size_t n_bins() const { return key.size(); }
  std::size_t n_particles() const { return index.size(); }
  /// Lower corner of a bin [m].
  Vec3 origin(std::size_t bin) const {
    const Lattice p = lattice_from_key(key[bin]);
    return edge * Vec3(p[0], p[1], p[2]);
  }
  /// Of a sorted particle of `bin` [m], to single precision within its bin.
  Vec3 position(std::size_t bin, std::size_t j) const {
    return origin(bin) + edge * Vec3(offset[0][j], offset[1][j], offset[2][j]);
  }
  /// Box around the particles of a bin [m].
  Box3 box(std::size_t bin) const;
};

/// Sorts `position` [m] into bins of `edge` [m]. Throws Error where a position is not finite or too far from the origin
/// for the lattice (2^20 bins); names the particle by its place in `position`.
ParticleBins sort_into_bins(std::span<const Vec3> position, double edge);

/// Calls `visit(bin)` for all bins that touch the box [lower, upper] [m], in ascending order of keys.
template <typename Visit>
void for_each_bin(const ParticleBins& bins, const Vec3& lower, const Vec3& upper, Visit&& visit) {
  Lattice low, high;
  for (int a = 0; a < 3; ++a) {
    low[a] = floor_to_int(lower[a] / bins.edge);
    high[a] = floor_to_int(upper[a] / bins.edge);
  }
  auto from = bins.key.begin();
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y) {
      from = std::lower_bound(from, bins.key.end(), lattice_key(low[0], y, z));
      for (const std::uint64_t last = lattice_key(high[0], y, z); from != bins.key.end() && *from <= last; ++from)
        visit(static_cast<std::size_t>(from - bins.key.begin()));
    }
}

}  // namespace smelt
