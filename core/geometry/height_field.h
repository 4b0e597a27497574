#pragma once
// Terrain as heights over a regular grid, and the meshes that it becomes.

#include "core/geometry/triangle_mesh.h"

#include <cstddef>
#include <vector>

namespace smelt {

/// Heights along y over a grid in the x-z plane. Rows run from north (-z) to south, within a row from west (-x) to
/// east; the middle of the grid is at x = z = 0.
struct HeightField {
  std::size_t n_columns = 0;  ///< at least 2, like n_rows
  std::size_t n_rows = 0;
  double cell = 0.0;           ///< distance between neighbours [m], > 0
  std::vector<double> height;  ///< row by row [m], finite

  double at(std::size_t column, std::size_t row) const { return height[row * n_columns + column]; }
};

/// `n` cells for each cell of `field` along both sides, by Catmull-Rom cubics through its heights: kinks go, heights
/// stay.
HeightField refine(const HeightField& field, int n);

/// The surface alone, open at its rim, facing up. Each cell is cut along the diagonal whose ends differ less in height.
TriangleMesh make_terrain_sheet(const HeightField& field);

/// The surface with walls from its rim down to a flat bottom at y = `bottom` [m], below all heights: closed, facing
/// out.
TriangleMesh make_terrain_solid(const HeightField& field, double bottom);

}  // namespace smelt
