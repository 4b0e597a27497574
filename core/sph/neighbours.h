#pragma once
// Neighbour search on a uniform grid, with lists that stay valid for several steps  [P 5.1].

#include "core/geometry/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace smelt {

/// Neighbour lists in compressed rows: the neighbours of i are index[begin[i] .. begin[i] + count[i]), itself left out, in the
/// order of the grid's cells. Each row is padded with i itself to a multiple of `row_multiple`: a particle's pair with itself
/// has x_ij = 0 and adds exactly nothing to any sum over differences.
struct NeighbourLists {
  std::vector<std::int32_t> index;
  std::vector<std::int64_t> begin;   ///< n entries
  std::vector<std::int32_t> count;   ///< n entries, without the padding
  std::vector<std::int32_t> padded;  ///< n entries, with it

  std::span<const std::int32_t> row(std::size_t i) const {
    return {index.data() + begin[i], static_cast<std::size_t>(count[i])};
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
