#include "surfacing/marching_cubes.h"

#include "core/error.h"
#include "tests/surfacing/dense_grid.h"
#include "tests/surfacing/mesh_checks.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>
#include <random>

namespace smelt {
namespace {

using testing::DenseGrid;
using testing::find_defect;
using testing::make_grid;
using testing::make_sparse;
using testing::smallest_area;

constexpr float iso = 0.5f;

DenseGrid random_grid(std::mt19937& random, bool with_ties) {
  std::uniform_int_distribution<int> size(3, 6), four(0, 3);
  std::uniform_real_distribution<float> value(0.0f, 1.0f);
  DenseGrid grid = make_grid({size(random), size(random), size(random)});
  for (float& f : grid.value) f = with_ties && four(random) == 0 ? iso : value(random);
  return grid;
}

/// What is wrong with the surface of one random grid.
std::string find_random_defect(unsigned seed, bool with_ties) {
  std::mt19937 random(seed);
  const DenseGrid grid = random_grid(random, with_ties);
  // One in eight lies across block borders, negative coordinates included; the others inside one block, for speed.
  std::uniform_int_distribution<int> shift(-9, 9);
  const Lattice origin = seed % 8 == 0 ? Lattice{shift(random), shift(random), shift(random)} : Lattice{1, 1, 1};
  const TriangleMesh mesh = extract_iso_surface(make_sparse(grid, origin), iso);
  if (mesh.triangles.empty()) return "";
  if (smallest_area(mesh) < 1e-6) return "a face without area";
  if (compute_volume(mesh) <= 0.0) return "inside out";
  return find_defect(mesh);
}

void expect_manifolds(bool with_ties) {
  constexpr unsigned n = 50000;
  std::vector<std::string> defects(n);
  tbb::parallel_for(0u, n, [&](unsigned seed) { defects[seed] = find_random_defect(seed, with_ties); });
  for (unsigned seed = 0; seed < n; ++seed) ASSERT_EQ(defects[seed], "") << "seed " << seed;
}

TEST(MarchingCubes, RandomGridsGiveClosedManifolds) {
  expect_manifolds(false);
}

TEST(MarchingCubes, RandomGridsWithSamplesAtTheIsoValueGiveClosedManifolds) {
  expect_manifolds(true);
}

TEST(MarchingCubes, EverySignPatternGivesAClosedOutwardMesh) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> below(0.0f, 0.4999f), above(0.5f, 1.0f);
  for (int pattern = 0; pattern < 256; ++pattern)
    for (int round = 0; round < 40; ++round) {
      DenseGrid grid = make_grid({2, 2, 2});
      for (int c = 0; c < 8; ++c) grid.value[c] = (pattern >> c & 1) != 0 ? above(random) : below(random);
      const TriangleMesh mesh = extract_iso_surface(make_sparse(grid, {1, 1, 1}), iso);
      ASSERT_EQ(find_defect(mesh), "") << "pattern " << pattern;
      ASSERT_EQ(mesh.triangles.empty(), pattern == 0);
      if (pattern != 0) {
        ASSERT_GT(compute_volume(mesh), 0.0) << "pattern " << pattern;
      }
    }
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
