#pragma once
// Filling the loops of one grid cell with triangles.

#include "surfacing/marching_cubes_table.h"

#include <cstdint>
#include <span>

namespace smelt {

// Both functions draw no edge between two vertices of one cell face except the segments of the loops themselves: the
// cell on the other side of that face may draw the same edge, and four triangles would then meet there. Among the rest
// they take the shortest edges, measured between the middles of the cell's edges. Where nothing is left they add inner
// vertices.

/// Adds a disc bounded by `loop` (edge ids).
void add_disc(CellSurface& surface, std::span<const std::uint8_t> loop);

/// Adds a tube bounded by two loops.
void add_tube(CellSurface& surface, std::span<const std::uint8_t> a, std::span<const std::uint8_t> b);

}  // namespace smelt
