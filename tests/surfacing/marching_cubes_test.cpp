#include "surfacing/marching_cubes.h"

#include "core/error.h"
#include "tests/accuracy/measure.h"
#include "tests/surfacing/dense_grid.h"
#include "tests/surfacing/mesh_checks.h"
#include "tests/surfacing/trilinear_topology.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>
#include <random>

namespace smelt {
namespace {

using testing::DenseGrid;
using testing::find_defect;
using testing::find_inverted_piece;
using testing::find_topology;
using testing::make_grid;
using testing::make_sparse;
using testing::smallest_area;
using testing::SurfaceTopology;

constexpr float iso = 0.5f;

DenseGrid random_grid(std::mt19937& random, bool with_ties) {
  std::uniform_int_distribution<int> size(3, 6), four(0, 3);
  std::uniform_real_distribution<float> value(0.0f, 1.0f);
  DenseGrid grid = make_grid({size(random), size(random), size(random)});
  for (float& f : grid.value) f = with_ties && four(random) == 0 ? iso : value(random);
  return grid;
}

/// What is wrong with the surface of a grid whose first sample is at `origin`, beside the topology of its interpolant.
std::string find_defect_of(const DenseGrid& grid, const Lattice& origin) {
  const TriangleMesh mesh = extract_iso_surface(make_sparse(grid, origin), iso);
  const SurfaceTopology wanted = find_topology(grid, iso);
  SurfaceTopology found;
  if (!mesh.triangles.empty()) {
    if (const std::string defect = find_defect(mesh); !defect.empty()) return defect;
    if (smallest_area(mesh) < 1e-6) return "a face without area";
    if (const std::string defect = find_inverted_piece(mesh); !defect.empty()) return defect;
    const MeshTopology t = compute_topology(mesh);
    found = {static_cast<int>(t.euler_characteristic), static_cast<int>(t.n_components)};
  }
  if (found == wanted) return "";
  return fmt::format("Euler characteristic {}, pieces {}, genus {}; of the interpolant {}, {}, {}", found.euler,
                     found.n_components, found.genus(), wanted.euler, wanted.n_components, wanted.genus());
}

std::string find_random_defect(unsigned seed, bool with_ties) {
  std::mt19937 random(seed);
  const DenseGrid grid = random_grid(random, with_ties);
  // One in eight lies across block borders, negative coordinates included; the others inside one block, for speed.
  std::uniform_int_distribution<int> shift(-9, 9);
  return find_defect_of(grid, seed % 8 == 0 ? Lattice{shift(random), shift(random), shift(random)} : Lattice{1, 1, 1});
}

void expect_topologies(bool with_ties) {
  const unsigned n = full_run() ? 100000 : 8000;
  std::vector<std::string> defects(n);
  tbb::parallel_for(0u, n, [&](unsigned seed) { defects[seed] = find_random_defect(seed, with_ties); });
  unsigned n_defects = 0;
  for (unsigned seed = 0; seed < n; ++seed)
    if (!defects[seed].empty() && ++n_defects <= 5) ADD_FAILURE() << "seed " << seed << ": " << defects[seed];
  EXPECT_EQ(n_defects, 0u) << "of " << n;
}

TEST(MarchingCubes, RandomGridsHaveTheTopologyOfTheInterpolant) {
  expect_topologies(false);
}

TEST(MarchingCubes, RandomGridsWithSamplesAtTheIsoValueHaveTheTopologyOfTheInterpolant) {
  expect_topologies(true);
}

TEST(MarchingCubes, EverySignPatternHasTheTopologyOfTheInterpolant) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> exponent(-3.0f, 0.0f);
  const int n_rounds = full_run() ? 4000 : 200;
  for (int pattern = 0; pattern < 256; ++pattern)
    for (int round = 0; round < n_rounds; ++round) {
      DenseGrid grid = make_grid({2, 2, 2});
      for (int c = 0; c < 8; ++c)
        grid.value[c] = iso * (1.0f + ((pattern >> c & 1) != 0 ? 1.0f : -1.0f) * std::pow(10.0f, exponent(random)));
      ASSERT_EQ(find_defect_of(grid, {1, 1, 1}), "") << "pattern " << pattern << " round " << round;
    }
}

/// The oracle itself, on shapes whose topology is known.
TEST(MarchingCubes, TheInterpolantsTopologyIsThatOfKnownShapes) {
  DenseGrid one = make_grid({1, 1, 1}, 1.0f);
  EXPECT_EQ(find_topology(one, iso), (SurfaceTopology{2, 1}));
  DenseGrid shell = make_grid({3, 3, 3}, 1.0f);
  shell.at(1, 1, 1) = 0.0f;
  EXPECT_EQ(find_topology(shell, iso), (SurfaceTopology{4, 2}));
  DenseGrid ring = make_grid({3, 3, 1}, 1.0f);
  ring.at(1, 1, 0) = 0.0f;
  EXPECT_EQ(find_topology(ring, iso), (SurfaceTopology{0, 1}));
  EXPECT_EQ(find_topology(ring, iso).genus(), 1);
  // A frame of twelve bars: a cube with a hole in each face has genus 5.
  DenseGrid frame = make_grid({3, 3, 3}, 1.0f);
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i)
        if ((i == 1) + (j == 1) + (k == 1) >= 2) frame.at(i, j, k) = 0.0f;
  EXPECT_EQ(find_topology(frame, iso).genus(), 5);
}

/// Samples of a function on a cube of n^3 lattice points around the middle.
template <typename Function>
DenseGrid sample_function(int n, Function&& f) {
  DenseGrid grid = make_grid({n, n, n});
  const double middle = 0.5 * (n - 1);
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) grid.at(i, j, k) = static_cast<float>(f(Vec3(i - middle, j - middle, k - middle)));
  return grid;
}

TEST(MarchingCubes, ABallHasTheTopologyAndVolumeOfABall) {
  const double radius = 10.0;
  const DenseGrid grid =
      sample_function(26, [&](const Vec3& x) { return std::max(0.0, 0.5 + 0.1 * (radius - x.norm())); });
  const TriangleMesh mesh = extract_iso_surface(make_sparse(grid, {-5, 3, 100}, 0.1), iso);
  ASSERT_EQ(find_defect(mesh), "");
  EXPECT_EQ(compute_topology(mesh).euler_characteristic, 2);
  const double exact = 4.0 / 3.0 * std::numbers::pi * std::pow(0.1 * radius, 3);
  EXPECT_NEAR(compute_volume(mesh) / exact, 1.0, 0.01);  // chords of a ball of 10 cells
  const Vec3 centre = 0.1 * Vec3(-5 + 12.5, 3 + 12.5, 100 + 12.5);
  for (const Vec3& x : mesh.vertices) ASSERT_NEAR((x - centre).norm(), 0.1 * radius, 0.0015);
}

TEST(MarchingCubes, ATorusHasNoEulerCharacteristic) {
  const DenseGrid grid = sample_function(26, [](const Vec3& x) {
    const double ring = std::hypot(x[0], x[1]) - 8.0;
    return std::max(0.0, 0.5 + 0.1 * (3.0 - std::hypot(ring, x[2])));
  });
  const TriangleMesh mesh = extract_iso_surface(make_sparse(grid), iso);
  ASSERT_EQ(find_defect(mesh), "");
  EXPECT_EQ(compute_topology(mesh).euler_characteristic, 0);
  EXPECT_EQ(compute_topology(mesh).n_components, 1u);
}

/// Two corners of a cell on its long diagonal, the case that signs on faces cannot decide: a bridge runs between them
/// where the trilinear interpolant says so.
TEST(MarchingCubes, CornersOnTheLongDiagonalAreBridgedWhereTheInterpolantIs) {
  for (const float others : {0.1f, 0.45f}) {
    DenseGrid grid = make_grid({2, 2, 2}, others);
    grid.at(0, 0, 0) = grid.at(1, 1, 1) = 1.0f;
    const TriangleMesh mesh = extract_iso_surface(make_sparse(grid), iso);
    ASSERT_EQ(find_defect(mesh), "");
    // Middle of the cell: (2 * 1 + 6 * others) / 8.
    const bool bridged = (2.0f + 6.0f * others) / 8.0f > iso;
    EXPECT_EQ(compute_topology(mesh).n_components, bridged ? 1u : 2u);
    EXPECT_EQ(compute_topology(mesh).euler_characteristic, bridged ? 2 : 4);
  }
}

TEST(MarchingCubes, AFieldWithoutRoomBelowIsOurBug) {
  SparseField field;
  field.cell = 1.0;
  field.key = {lattice_key(0, 0, 0)};
  field.value.assign(SparseField::block_size, 0.0f);
  field.value[0] = 1.0f;
  EXPECT_THROW(extract_iso_surface(field, iso), InternalError);
  EXPECT_THROW(extract_iso_surface(field, 0.0f), Error);
}

}  // namespace
}  // namespace smelt
