#pragma once
// Neighbour search on a uniform grid, with lists that stay valid for several steps  [P 5.1].

#include "core/geometry/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace smelt {

/// The neighbours of each particle, itself left out, in the order of the grid's cells. Each row is padded with the particle itself to a
/// multiple of `row_multiple`: its pair with itself has x_ij = 0 and adds exactly nothing to any sum over differences. Rows lie in blocks, as
/// the search makes them: joining them would take a second copy of what is most of a simulation's memory.
struct NeighbourLists {
  std::vector<std::vector<std::int32_t>> blocks;
  std::vector<const std::int32_t*> begin;  ///< of each particle's row, in one of the blocks
  std::vector<std::int32_t> count;         ///< of neighbours, without the padding
  int row_multiple = 1;

  NeighbourLists() = default;
  NeighbourLists(NeighbourLists&&) = default;
  NeighbourLists& operator=(NeighbourLists&&) = default;
  NeighbourLists(const NeighbourLists&) = delete;  // `begin` points into `blocks`
  NeighbourLists& operator=(const NeighbourLists&) = delete;

  std::size_t size() const { return count.size(); }
  std::span<const std::int32_t> row(std::size_t i) const { return {begin[i], static_cast<std::size_t>(count[i])}; }
  /// With the padding.
  std::span<const std::int32_t> padded_row(std::size_t i) const { return {begin[i], padded(static_cast<std::size_t>(count[i]))}; }
  std::size_t padded(std::size_t n) const {
    const auto multiple = static_cast<std::size_t>(row_multiple);
    return (n + multiple - 1) / multiple * multiple;
  }
  std::size_t n_bytes() const {
    std::size_t n = begin.size() * sizeof(begin[0]) + count.size() * sizeof(count[0]);
    for (const auto& block : blocks) n += block.size() * sizeof(block[0]);
    return n;
  }
};

/// A permutation that puts particles of one grid cell (edge `cell_size` [m]) next to one another, cells near one another where they
/// can be, particles of a cell by id: it depends on positions and ids only, not on the order they come in.
/// Throws InternalError where a position is not finite or the grid would need more than 2^21 cells along an axis.
template <int Dim>
std::vector<std::int32_t> compute_cell_order(std::span<const Vec<Dim>> position, std::span<const std::int32_t> id,
                                             double cell_size);

/// All pairs with |x_ij| < radius. `position` must be in the order of compute_cell_order with cell_size >= radius.
template <int Dim>
void build_neighbour_lists(std::span<const Vec<Dim>> position, double radius, double cell_size, int row_multiple,
                           NeighbourLists& lists);

}  // namespace smelt
