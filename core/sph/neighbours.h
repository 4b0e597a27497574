#pragma once
// Neighbour search on a uniform grid, with lists that stay valid for several steps  [P 5.1].

#include "core/geometry/vec.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <immintrin.h>
#include <memory_resource>
#include <span>
#include <vector>

namespace smelt {

/// The neighbours of each particle, itself left out, in a byte each: these rows are most of what a simulation keeps in
/// memory. What the particles of a grid cell may have in reach lies in a few runs of particles near one another, the
/// same for all of them. A row says for each run how many of its particles are neighbours, then which, counted from the
/// run's first.
struct NeighbourLists {
  static constexpr std::size_t cells_per_block = 64;
  static constexpr std::int32_t max_run = 255;  ///< particles: places in a run and counts of them fit a byte
  static constexpr std::size_t max_multiple = 16;
  static constexpr std::size_t step = 32;  ///< places that are read at once; a block ends in as many that nobody means

  /// The rows of a number of cells, as the search makes them: one thread a block.
  struct Block {
    std::array<std::uint32_t, cells_per_block + 1> first_run{};  ///< of each cell among `run_begin`
    std::vector<std::int32_t> run_begin;                         ///< the first particle of each run
    std::vector<std::uint8_t> bytes;
  };
  /// Where the row of a particle is.
  struct Place {
    std::uint32_t cell, byte;
  };
  /// A row spelled out. It is padded with the particle itself to a multiple of `row_multiple`: its pair with itself has
  /// x_ij = 0 and adds exactly nothing to any sum over differences.
  struct Row {
    std::span<const std::int32_t> neighbours, padded;
  };

  std::vector<Block> blocks;
  std::vector<Place> places;
  std::vector<std::int32_t> names;  ///< what places in the order of the search stand for; empty: themselves
  std::size_t longest = 0;          ///< row, in neighbours
  /// So many particles after one lie those that rows will soon name for the first time: a pass may fetch them ahead.
  std::size_t look_ahead = 0;
  int row_multiple = 1;  ///< a power of two, up to max_multiple

  std::size_t size() const { return places.size(); }
  std::size_t n_bytes() const;  ///< set aside, what rows may grow to included
  /// Entries that a buffer for any row needs.
  std::size_t room() const { return longest + static_cast<std::size_t>(row_multiple) + step; }

  /// The row of particle `i`, written to `buffer`, which has room for it: each neighbour times `stride`, which is where
  /// it begins in an array of so many numbers a particle. Beyond 2^31 these wrap: take them as unsigned.
  template <std::uint32_t stride = 1>
  Row read(std::size_t i, std::int32_t* buffer) const {
    const Block& block = blocks[places[i].cell / cells_per_block];
    const std::size_t cell = places[i].cell % cells_per_block;
    const std::uint32_t first_run = block.first_run[cell], end_run = block.first_run[cell + 1];
    const std::uint8_t* count = block.bytes.data() + places[i].byte;
    const std::uint8_t* place = count + (end_run - first_run);
    std::int32_t* end = buffer;
    for (std::uint32_t run = first_run; run < end_run; ++run, ++count) {
      // A whole step each time, most often the only one: what is beyond a run's last the next run overwrites.
      spell_out<stride>(block.run_begin[run], place, end);
      for (std::size_t done = step; done < *count; done += step)
        spell_out<stride>(block.run_begin[run], place + done, end + done);
      end += *count;
      place += *count;
    }
    const auto n = static_cast<std::size_t>(end - buffer);
    for (std::size_t k = 0; k < n && !names.empty(); ++k)
      buffer[k] = times<stride>(names[static_cast<std::uint32_t>(buffer[k]) / stride]);
    // No fewer than are wanted, and of a known number.
    std::fill_n(end, max_multiple, times<stride>(static_cast<std::int32_t>(i)));
    const auto multiple = static_cast<std::size_t>(row_multiple);
    const std::size_t n_padded = (n + multiple - 1) & ~(multiple - 1);
    return {{buffer, n}, {buffer, n_padded}};
  }

  /// The neighbours of particle `i`, where time does not matter.
  std::vector<std::int32_t> row(std::size_t i) const;

 private:
  template <std::uint32_t stride>
  static std::int32_t times(std::int32_t place) {
    return static_cast<std::int32_t>(stride * static_cast<std::uint32_t>(place));
  }

  /// By hand: the compiler takes four scalar instructions a place.
  template <std::uint32_t stride>
  static void spell_out(std::int32_t begin, const std::uint8_t* place, std::int32_t* out) {
    static_assert(step % 8 == 0 && std::has_single_bit(stride));
    constexpr int shift = std::countr_zero(stride);
    const __m256i first = _mm256_set1_epi32(times<stride>(begin));
#pragma GCC unroll 4
    for (std::size_t k = 0; k < step; k += 8) {
      const __m256i after = _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(place + k)));
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + k),
                          _mm256_add_epi32(first, _mm256_slli_epi32(after, shift)));
    }
  }
};

/// The box around all of them [m].
template <int Dim>
Box<Dim> bounds_of(std::span<const Vec<Dim>> position);

/// A permutation that puts particles of one grid cell (edge `cell_size` [m]) next to one another, cells near one
/// another where they can be, particles of a cell by id: it depends on positions and ids only, not on the order they
/// come in. It takes 12 bytes a particle from `memory`. Throws InternalError where a position is not finite or the grid
/// would need more than 2^21 cells along an axis.
template <int Dim>
std::pmr::vector<std::int32_t> compute_cell_order(std::span<const Vec<Dim>> position, std::span<const std::int32_t> id,
                                                  double cell_size,
                                                  std::pmr::memory_resource* memory = std::pmr::get_default_resource());

/// All pairs with |x_ij| < radius, and none that is farther by more than two millionths of `cell_size`: distances are
/// compared in single precision. `position` must be in the order of compute_cell_order with cell_size >= radius.
template <int Dim>
void build_neighbour_lists(std::span<const Vec<Dim>> position, double radius, double cell_size, int row_multiple,
                           NeighbourLists& lists);

}  // namespace smelt
