#pragma once
// The topology of {f >= iso} for the piecewise trilinear interpolant f of a grid, from its critical points: no case
// tables, no deciders.

#include "tests/surfacing/dense_grid.h"

namespace smelt::testing {

/// Of the surface f = iso, which bounds {f >= iso}.
struct SurfaceTopology {
  int euler = 0;                                          ///< characteristic
  int n_components = 0;                                   ///< connected pieces
  int genus() const { return n_components - euler / 2; }  ///< handles of all pieces together
  bool operator==(const SurfaceTopology&) const = default;
};

/// By stratified Morse theory. Euler characteristic: that of {f >= iso} adds up over open vertices, edges, faces and
/// cells of the grid, each from the critical points of f on it with values >= iso; the surface has twice as much.
/// Pieces: parts of {f >= iso} and of {f < iso} grow from grid vertices, which hold all local extremes of f, and merge
/// along edges, through the saddles of faces, and through those of cells, from which f is followed uphill (downhill)
/// both ways to a vertex; in space, pieces of surface = parts of both kinds - 1. Samples at the iso-value are lifted by
/// the rule of surfacing/marching_cubes.h. `grid` is surrounded by samples of 0, `iso` is positive.
SurfaceTopology find_topology(const DenseGrid& grid, float iso);

}  // namespace smelt::testing
