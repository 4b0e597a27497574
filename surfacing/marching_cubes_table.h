#pragma once
// How a grid cell is cut: generated once from the definition, not copied from a published table.
//
// A corner is inside when its sample is at or above the iso-value. Corner n of a cell lies at (n & 1, n >> 1 & 1, n >>
// 2 & 1). Edge 4 a + u + 2 v runs along axis a from the corner whose coordinates along the two other axes, in ascending
// order, are u and v. Face 2 a + s lies at coordinate s of axis a. A face is ambiguous when its inside corners sit on
// one diagonal; it is "joined" when they are connected through its middle.

#include <array>
#include <cstdint>
#include <vector>

namespace smelt {

/// Triangles of one cell: ids 0..11 are the vertices on the cell's edges, 12 + i is inner vertex i, which lies at the
/// mean of the edge vertices in `inner[i]`. Counter-clockwise seen from outside the fluid.
struct CellSurface {
  std::vector<std::array<std::uint8_t, 3>> triangles;
  std::vector<std::vector<std::uint8_t>> inner;
};

/// The same cell with loops `first` and `second` joined by a tube instead of closed by a disc each.
struct CellTunnel {
  std::uint8_t first, second;
  CellSurface surface;
};

/// One sign pattern with one decision for each of its ambiguous faces.
struct CellCase {
  /// Closed polygons in which the surface meets the cell's boundary, as edge ids, ordered as a disc in them must wind.
  std::vector<std::vector<std::uint8_t>> loops;
  /// Connected region of the cell's boundary that holds each corner; inside and outside corners never share one.
  std::array<std::uint8_t, 8> region{};
  CellSurface discs;                ///< every loop closed by a disc
  std::vector<CellTunnel> tunnels;  ///< every pair of loops that a tube could join
};

struct MarchingCubesTable {
  std::array<std::uint8_t, 256> ambiguous_faces{};  ///< bit f: face f is ambiguous in this sign pattern
  std::array<std::uint16_t, 257> first{};           ///< cases of a pattern: first[pattern] .. first[pattern + 1] - 1
  std::vector<CellCase> cases;

  /// `joined` has bit f set where ambiguous face f is joined; other bits are ignored. Pattern bit n: corner n is
  /// inside.
  const CellCase& find(std::uint8_t pattern, std::uint8_t joined) const;
};

/// Corners at the two ends of an edge, the lower one first.
std::array<std::uint8_t, 2> edge_corners(int edge);

/// The four corners of a face, in the order (0,0), (1,0), (0,1), (1,1) of its two axes: the same from both of its
/// cells.
std::array<std::uint8_t, 4> face_corners(int face);

/// The table, made on first use (about 10 ms) and shared; safe from any thread.
const MarchingCubesTable& marching_cubes_table();

}  // namespace smelt
