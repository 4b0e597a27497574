#include "surfacing/marching_cubes_table.h"

#include "core/error.h"
#include "surfacing/triangulate_loops.h"

#include <algorithm>
#include <bit>

namespace smelt {

namespace {

bool inside(unsigned pattern, int corner) {
  return (pattern >> corner & 1u) != 0;
}

/// The corners of a face counter-clockwise as seen from outside the cell.
std::array<std::uint8_t, 4> face_cycle(int face) {
  const auto c = face_corners(face);
  // (u, v, axis) is right-handed for axes x and z, left-handed for y (u = x, v = z); the lower face looks the other
  // way.
  const bool along_axis = (face >> 1) != 1;
  const bool upper = (face & 1) != 0;
  if (along_axis == upper) return {c[0], c[1], c[3], c[2]};
  return {c[0], c[2], c[3], c[1]};
}

std::uint8_t edge_between(int corner_a, int corner_b) {
  const int axis = std::countr_zero(static_cast<unsigned>(corner_a ^ corner_b));
  const int low = std::min(corner_a, corner_b);
  const int u = low >> (axis == 0 ? 1 : 0) & 1, v = low >> (axis == 2 ? 1 : 2) & 1;
  return static_cast<std::uint8_t>(4 * axis + u + 2 * v);
}

bool ambiguous(unsigned pattern, int face) {
  const auto c = face_corners(face);
  return inside(pattern, c[0]) == inside(pattern, c[3]) && inside(pattern, c[1]) == inside(pattern, c[2]) &&
         inside(pattern, c[0]) != inside(pattern, c[1]);
}

/// Joins corners that are connected on the boundary of the cell: along edges, and through the middle of ambiguous
/// faces.
void find_regions(CellCase& cell, unsigned pattern, unsigned joined) {
  auto& region = cell.region;
  for (int c = 0; c < 8; ++c) region[c] = static_cast<std::uint8_t>(c);
  const auto merge = [&](int a, int b) {
    const auto keep = std::min(region[a], region[b]), drop = std::max(region[a], region[b]);
    std::replace(region.begin(), region.end(), drop, keep);
  };
  for (int e = 0; e < 12; ++e)
    if (const auto [a, b] = edge_corners(e); inside(pattern, a) == inside(pattern, b)) merge(a, b);
  for (int f = 0; f < 6; ++f) {
    if (!ambiguous(pattern, f)) continue;
    const auto c = face_corners(f);
    const bool connect_inside = (joined >> f & 1u) != 0;
    if (inside(pattern, c[0]) == connect_inside)
      merge(c[0], c[3]);
    else
      merge(c[1], c[2]);
  }
}

/// Each crossed edge is the end of one segment and the start of another. On a face, seen from outside the cell and
/// walked counter-clockwise, a segment runs from an edge that enters the fluid to one that leaves it.
std::array<int, 12> link_segments(unsigned pattern, unsigned joined) {
  std::array<int, 12> next;
  next.fill(-1);
  for (int f = 0; f < 6; ++f) {
    const auto cycle = face_cycle(f);
    const bool connect_inside = ambiguous(pattern, f) && (joined >> f & 1u) != 0;
    for (int i = 0; i < 4; ++i) {
      const int from = cycle[i], to = cycle[(i + 1) % 4];
      if (inside(pattern, from) || !inside(pattern, to)) continue;
      // Entering edge. The segment cuts off the inside corners that follow it (walk on to where the fluid is left),
      // unless the middle of the face is inside: then it cuts off the outside corner before it (walk back).
      int leave = connect_inside ? i + 3 : i + 1;
      while (inside(pattern, cycle[leave % 4]) == inside(pattern, cycle[(leave + 1) % 4])) ++leave;
      next[edge_between(from, to)] = edge_between(cycle[leave % 4], cycle[(leave + 1) % 4]);
    }
  }
  return next;
}

void trace_loops(CellCase& cell, unsigned pattern, unsigned joined) {
  auto next = link_segments(pattern, joined);
  for (int start = 0; start < 12; ++start) {
    if (next[start] < 0) continue;
    auto& loop = cell.loops.emplace_back();
    for (int e = start; next[e] >= 0;) {
      loop.push_back(static_cast<std::uint8_t>(e));
      e = std::exchange(next[e], -1);
    }
    CHECK_GE(loop.size(), 3u);
  }
}

/// The two regions that a loop separates.
std::array<std::uint8_t, 2> sides(const CellCase& cell, const std::vector<std::uint8_t>& loop) {
  const auto [a, b] = edge_corners(loop.front());
  return {std::min(cell.region[a], cell.region[b]), std::max(cell.region[a], cell.region[b])};
}

CellCase make_case(unsigned pattern, unsigned joined) {
  CellCase cell;
  find_regions(cell, pattern, joined);
  trace_loops(cell, pattern, joined);
  for (const auto& loop : cell.loops) add_disc(cell.discs, loop);
  for (std::size_t a = 0; a < cell.loops.size(); ++a)
    for (std::size_t b = a + 1; b < cell.loops.size(); ++b) {
      const auto s = sides(cell, cell.loops[a]), t = sides(cell, cell.loops[b]);
      if (s[0] != t[0] && s[0] != t[1] && s[1] != t[0] && s[1] != t[1]) continue;  // no region between the two
      CellTunnel tunnel{static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b), {}};
      add_tube(tunnel.surface, cell.loops[a], cell.loops[b]);
      for (std::size_t c = 0; c < cell.loops.size(); ++c)
        if (c != a && c != b) add_disc(tunnel.surface, cell.loops[c]);
      cell.tunnels.push_back(std::move(tunnel));
    }
  return cell;
}

MarchingCubesTable make_table() {
  MarchingCubesTable table;
  for (unsigned pattern = 0; pattern < 256; ++pattern) {
    unsigned faces = 0;
    for (int f = 0; f < 6; ++f) faces |= static_cast<unsigned>(ambiguous(pattern, f)) << f;
    table.ambiguous_faces[pattern] = static_cast<std::uint8_t>(faces);
    table.first[pattern] = static_cast<std::uint16_t>(table.cases.size());
    // Every subset of the ambiguous faces, in the order in which `find` counts them.
    const unsigned n_cases = 1u << std::popcount(faces);
    for (unsigned choice = 0; choice < n_cases; ++choice) {
      unsigned joined = 0, bit = 0;
      for (int f = 0; f < 6; ++f)
        if (faces >> f & 1u) joined |= (choice >> bit++ & 1u) << f;
      table.cases.push_back(make_case(pattern, joined));
    }
  }
  table.first[256] = static_cast<std::uint16_t>(table.cases.size());
  return table;
}

}  // namespace

std::array<std::uint8_t, 2> edge_corners(int edge) {
  const int axis = edge >> 2, u = edge & 1, v = edge >> 1 & 1;
  const int low = u << (axis == 0 ? 1 : 0) | v << (axis == 2 ? 1 : 2);
  return {static_cast<std::uint8_t>(low), static_cast<std::uint8_t>(low | 1 << axis)};
}

std::array<std::uint8_t, 4> face_corners(int face) {
  const int axis = face >> 1;
  const int u = 1 << (axis == 0 ? 1 : 0), v = 1 << (axis == 2 ? 1 : 2);
  const int base = (face & 1) << axis;
  return {static_cast<std::uint8_t>(base), static_cast<std::uint8_t>(base | u), static_cast<std::uint8_t>(base | v),
          static_cast<std::uint8_t>(base | u | v)};
}

const CellCase& MarchingCubesTable::find(std::uint8_t pattern, std::uint8_t joined) const {
  unsigned choice = 0, bit = 0;
  for (unsigned faces = ambiguous_faces[pattern]; faces != 0; faces &= faces - 1)
    choice |= static_cast<unsigned>(joined >> std::countr_zero(faces) & 1) << bit++;
  return cases[first[pattern] + choice];
}

const MarchingCubesTable& marching_cubes_table() {
  static const MarchingCubesTable table = make_table();
  return table;
}

}  // namespace smelt
