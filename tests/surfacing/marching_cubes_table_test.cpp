#include "surfacing/marching_cubes_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>
#include <set>

namespace smelt {
namespace {

using Segment = std::pair<int, int>;

bool crossed(unsigned pattern, int edge) {
  const auto [a, b] = edge_corners(edge);
  return (pattern >> a & 1u) != (pattern >> b & 1u);
}

bool share_a_face(int edge_a, int edge_b) {
  for (int f = 0; f < 6; ++f) {
    const auto c = face_corners(f);
    const auto on_face = [&](int e) {
      const auto ends = edge_corners(e);
      return std::count(c.begin(), c.end(), ends[0]) + std::count(c.begin(), c.end(), ends[1]) == 2;
    };
    if (on_face(edge_a) && on_face(edge_b)) return true;
  }
  return false;
}

/// Directed edges that only one triangle has: the boundary of the piece of surface.
std::set<Segment> boundary(const CellSurface& surface) {
  std::map<Segment, int> count;
  for (const auto& t : surface.triangles)
    for (int i = 0; i < 3; ++i) ++count[{t[i], t[(i + 1) % 3]}];
  std::set<Segment> out;
  for (const auto& [s, n] : count) {
    EXPECT_EQ(n, 1);
    if (!count.contains({s.second, s.first})) out.insert(s);
  }
  return out;
}

void check_surface(const CellCase& cell, const CellSurface& surface, int euler) {
  std::set<Segment> segments;
  for (const auto& loop : cell.loops)
    for (std::size_t i = 0; i < loop.size(); ++i) segments.insert({loop[i], loop[(i + 1) % loop.size()]});
  EXPECT_EQ(boundary(surface), segments);

  std::set<int> vertices;
  std::set<Segment> edges;
  for (const auto& t : surface.triangles)
    for (int i = 0; i < 3; ++i) {
      const int a = t[i], b = t[(i + 1) % 3];
      vertices.insert(a);
      edges.insert({std::min(a, b), std::max(a, b)});
      // An edge in a face of the cell may only be a segment that the neighbour has too.
      if (a < 12 && b < 12 && share_a_face(a, b)) {
        EXPECT_TRUE(segments.contains({a, b}) || segments.contains({b, a}));
      }
    }
  EXPECT_EQ(
      static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) + static_cast<int>(surface.triangles.size()),
      euler);
}

TEST(MarchingCubesTable, EveryCaseClosesItsLoops) {
  const MarchingCubesTable& table = marching_cubes_table();
  for (unsigned pattern = 0; pattern < 256; ++pattern) {
    EXPECT_EQ(table.first[pattern + 1] - table.first[pattern], 1 << std::popcount(table.ambiguous_faces[pattern]));
    for (unsigned i = table.first[pattern]; i < table.first[pattern + 1]; ++i) {
      const CellCase& cell = table.cases[i];
      // Each crossed edge once, in one loop.
      std::multiset<int> in_loops;
      for (const auto& loop : cell.loops) in_loops.insert(loop.begin(), loop.end());
      for (int e = 0; e < 12; ++e) EXPECT_EQ(in_loops.count(e), crossed(pattern, e) ? 1u : 0u);
      // L loops cut a sphere into L + 1 regions.
      const std::set<int> regions(cell.region.begin(), cell.region.end());
      EXPECT_EQ(regions.size(), cell.loops.size() + 1);

      const int n_loops = static_cast<int>(cell.loops.size());
      check_surface(cell, cell.discs, n_loops);
      for (const CellTunnel& tunnel : cell.tunnels) check_surface(cell, tunnel.surface, n_loops - 2);
    }
  }
}

TEST(MarchingCubesTable, SwappingInsideAndOutsideSwapsFaceDecisions) {
  const MarchingCubesTable& table = marching_cubes_table();
  for (unsigned pattern = 0; pattern < 256; ++pattern)
    for (unsigned joined = 0; joined < 64; ++joined) {
      const auto loops_of = [&](unsigned p, unsigned j) {
        std::multiset<std::set<int>> sets;
        for (const auto& loop : table.find(static_cast<std::uint8_t>(p), static_cast<std::uint8_t>(j)).loops)
          sets.insert(std::set<int>(loop.begin(), loop.end()));
        return sets;
      };
      ASSERT_EQ(loops_of(pattern, joined), loops_of(~pattern & 255u, ~joined & 63u));
    }
}

TEST(MarchingCubesTable, OneInsideCornerIsCutOffFacingAway) {
  const CellCase& cell = marching_cubes_table().find(1, 0);
  ASSERT_EQ(cell.loops.size(), 1u);
  // From the x edge to the y edge to the z edge of corner 0: counter-clockwise seen from (1, 1, 1).
  EXPECT_EQ(cell.loops[0], (std::vector<std::uint8_t>{0, 4, 8}));
}

}  // namespace
}  // namespace smelt
