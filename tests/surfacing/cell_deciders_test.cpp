#include "surfacing/cell_deciders.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace smelt {
namespace {

std::uint8_t pattern_of(const CellSamples& f) {
  unsigned pattern = 0;
  for (int c = 0; c < 8; ++c) pattern |= static_cast<unsigned>(f[c] >= 0.0f) << c;
  return static_cast<std::uint8_t>(pattern);
}

const CellCase& case_of(const CellSamples& f) {
  const MarchingCubesTable& table = marching_cubes_table();
  return table.find(pattern_of(f), decide_faces(f, table.ambiguous_faces[pattern_of(f)]));
}

CellSamples random_cell(std::mt19937& random) {
  std::uniform_real_distribution<float> value(-1.0f, 1.0f);
  CellSamples f;
  for (float& x : f) x = value(random);
  return f;
}

TEST(CellDeciders, TheSaddleDecidesAFace) {
  // Inside 1, 1 on a diagonal of the lower z face; the saddle is (1 - r s)/(2 + r + s) for outside -r, -s.
  const auto joined = [](float r, float s) {
    const CellSamples f = {1.0f, -r, -s, 1.0f, -2.0f, -2.0f, -2.0f, -2.0f};
    return (decide_faces(f, 1u << 4) >> 4 & 1) != 0;
  };
  EXPECT_TRUE(joined(0.5f, 1.0f));
  EXPECT_FALSE(joined(1.5f, 1.0f));
  EXPECT_TRUE(joined(2.0f, 0.5f)) << "a saddle exactly at the iso-value joins";
}

TEST(CellDeciders, BothCellsOfAFaceDecideAlike) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> quarter(-4, 4);
  for (int round = 0; round < 40000; ++round)
    for (int axis = 0; axis < 3; ++axis) {
      // Every second face has multiples of 1/4, where ties are common.
      CellSamples low = random_cell(random), high = random_cell(random);
      const auto upper = face_corners(2 * axis + 1), lower = face_corners(2 * axis);
      for (int i = 0; i < 4; ++i) {
        if (round % 2 == 0) low[upper[i]] = 0.25f * static_cast<float>(quarter(random));
        high[lower[i]] = low[upper[i]];
      }
      const MarchingCubesTable& table = marching_cubes_table();
      const std::uint8_t a = table.ambiguous_faces[pattern_of(low)], b = table.ambiguous_faces[pattern_of(high)];
      ASSERT_EQ(a >> (2 * axis + 1) & 1, b >> (2 * axis) & 1);
      ASSERT_EQ(decide_faces(low, a) >> (2 * axis + 1) & 1, decide_faces(high, b) >> (2 * axis) & 1);
    }
}

/// Connected parts of {f >= level} and {f < level} in the cell, by flooding a fine grid; the trilinear interpolant
/// evaluated directly.
int count_parts(const CellSamples& f, double level) {
  constexpr int n = 24;
  std::vector<int> mark(n * n * n);
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double x = i / (n - 1.0), y = j / (n - 1.0), z = k / (n - 1.0);
        double value = 0.0;
        for (int c = 0; c < 8; ++c)
          value += f[c] * ((c & 1) != 0 ? x : 1 - x) * ((c & 2) != 0 ? y : 1 - y) * ((c & 4) != 0 ? z : 1 - z);
        mark[i + n * (j + n * k)] = value >= level ? 1 : -1;
      }
  int parts = 0;
  std::vector<int> stack;
  for (int start = 0; start < n * n * n; ++start) {
    if (mark[start] == 0) continue;
    ++parts;
    const int kind = std::exchange(mark[start], 0);
    stack.push_back(start);
    while (!stack.empty()) {
      const int at = stack.back();
      stack.pop_back();
      const std::array<int, 3> p = {at % n, at / n % n, at / n / n};
      constexpr std::array<int, 3> stride = {1, n, n * n};
      for (int a = 0; a < 3; ++a)
        for (const int d : {-1, 1}) {
          if (p[a] + d < 0 || p[a] + d >= n || mark[at + d * stride[a]] != kind) continue;
          mark[at + d * stride[a]] = 0;
          stack.push_back(at + d * stride[a]);
        }
    }
  }
  return parts;
}

TEST(CellDeciders, TunnelsAreThoseOfTheInterpolant) {
  std::mt19937 random(2);
  int n_discs = 0, n_tunnels = 0;
  for (int round = 0; round < 40000; ++round) {
    const CellSamples f = random_cell(random);
    const CellCase& cell = case_of(f);
    if (cell.tunnels.empty()) continue;
    const bool tunnel = find_tunnel(f, cell) != nullptr;
    if (!tunnel && n_discs >= 150) continue;  // tunnels are rare, and worth the wait
    // A grid cannot see what hangs on a hair: keep the cells whose parts are the same a little above and below.
    const int parts = count_parts(f, 0.0);
    bool robust = true;
    for (const double level : {0.04, -0.04, 0.02, -0.02, 0.01, -0.01})
      robust = robust && count_parts(f, level) == parts;
    if (!robust) continue;
    const int n_regions = static_cast<int>(cell.loops.size()) + 1;
    ASSERT_EQ(parts, tunnel ? n_regions - 1 : n_regions) << "round " << round;
    ++(tunnel ? n_tunnels : n_discs);
  }
  EXPECT_EQ(n_discs, 150);
  EXPECT_GE(n_tunnels, 10);
}

TEST(CellDeciders, TunnelsDoNotDependOnTheAxisOfTheSweep) {
  std::mt19937 random(3);
  int n_tunnels = 0;
  for (int round = 0; round < 100000; ++round) {
    const CellSamples f = random_cell(random);
    CellSamples turned;  // x -> y -> z -> x
    for (int c = 0; c < 8; ++c) turned[(c << 1 & 7) | c >> 2] = f[c];
    CellSamples mirrored;  // z -> 1 - z
    for (int c = 0; c < 8; ++c) mirrored[c ^ 4] = f[c];
    const auto has_tunnel = [](const CellSamples& g) { return find_tunnel(g, case_of(g)) != nullptr; };
    ASSERT_EQ(has_tunnel(f), has_tunnel(turned)) << "round " << round;
    ASSERT_EQ(has_tunnel(f), has_tunnel(mirrored)) << "round " << round;
    n_tunnels += has_tunnel(f);
  }
  EXPECT_GT(n_tunnels, 100);
}

}  // namespace
}  // namespace smelt
