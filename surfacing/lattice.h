#pragma once
// Integer triples packed into one sortable word: how blocks of samples and bins of particles are named.

#include <array>
#include <cmath>
#include <cstdint>

namespace smelt {

using Lattice = std::array<int, 3>;

/// Largest |coordinate| that `lattice_key` can hold, a few steps short of 2^20 so that neighbours fit too.
constexpr int lattice_limit = (1 << 20) - 16;

/// Ascending keys run through x first, then y, then z, so a run of neighbours along x is a run of keys.
constexpr std::uint64_t lattice_key(int x, int y, int z) {
  constexpr int offset = 1 << 20;
  return static_cast<std::uint64_t>(z + offset) << 42 | static_cast<std::uint64_t>(y + offset) << 21 |
         static_cast<std::uint64_t>(x + offset);
}
constexpr std::uint64_t lattice_key(const Lattice& p) {
  return lattice_key(p[0], p[1], p[2]);
}

constexpr Lattice lattice_from_key(std::uint64_t key) {
  constexpr int offset = 1 << 20;
  constexpr std::uint64_t mask = (1u << 21) - 1;
  return {static_cast<int>(key & mask) - offset, static_cast<int>(key >> 21 & mask) - offset,
          static_cast<int>(key >> 42 & mask) - offset};
}

/// Rounds towards minus infinity; the caller has made sure that the result fits.
inline int floor_to_int(double x) {
  return static_cast<int>(std::floor(x));
}

}  // namespace smelt
