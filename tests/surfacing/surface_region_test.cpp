#include "surfacing/surface_region.h"

#include "core/error.h"
#include "surfacing/estimate_spacing.h"
#include "surfacing/marching_cubes.h"
#include "surfacing/mesh_adjacency.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>

namespace smelt {
namespace {

/// Lattice points of a box, each moved by up to `shaken` spacings along each axis; `keep` sees them before.
template <typename Keep>
std::vector<Vec3> make_fluid(std::mt19937& random, int n, double spacing, double shaken, Keep&& keep) {
  std::uniform_real_distribution<double> uniform(-shaken * spacing, shaken * spacing);
  std::vector<Vec3> x;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        if (const Vec3 at = spacing * Vec3(i, j, k); keep(at))
          x.push_back(at + Vec3(uniform(random), uniform(random), uniform(random)));
  return x;
}

/// Signed volumes of the pieces of a mesh, ascending: cavities are negative.
std::vector<double> piece_volumes(const TriangleMesh& mesh) {
  const MeshComponents pieces = find_components(mesh);
  std::vector<double> volume(pieces.count);
  for (const auto& t : mesh.triangles)
    volume[pieces.of_vertex[t[0]]] += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]])) / 6.0;
  std::sort(volume.begin(), volume.end());
  return volume;
}

/// The surface found near the surface alone is that of the whole field, but for dust: fluids shaken by 0.3 spacings
/// with bubbles of 1 to 3 spacings in them, at three cells, with round and flat
/// kernels. What is left out are cavities below a tenth of a particle's
/// volume, and few.
TEST(SurfaceRegion, TheSurfaceIsThatOfTheWholeField) {
  const double spacing = 0.03, h = spacing;
  std::size_t n_left_out = 0, n_missing = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(0.0, 24.0 * spacing), size(1.0 * spacing, 3.0 * spacing);
    std::vector<std::pair<Vec3, double>> bubbles;
    for (unsigned b = 0; b < seed; ++b)
      bubbles.emplace_back(Vec3(place(random), place(random), place(random)), size(random));
    const auto keep = [&](const Vec3& x) {
      for (const auto& [centre, radius] : bubbles)
        if ((x - centre).norm() < radius) return false;
      return true;
    };
    const std::vector<Vec3> x = make_fluid(random, 24, spacing, 0.3, keep);
    const ParticleBins bins = sort_into_bins(x, 2.0 * h);
    const std::vector<float> volume(x.size(), static_cast<float>(spacing * spacing * spacing));
    const SurfaceRegion region = find_surface_region(bins, volume, spacing);
    const KernelShapes shapes = compute_kernel_shapes(bins, region, spacing, h);
    for (const auto& [cell, shaped] : {std::pair{0.3, false}, {0.5, false}, {0.75, false}, {0.5, true}, {0.75, true}}) {
      const ChiSource source{bins, volume, h, shaped ? &shapes : nullptr};
      const SparseField all = compute_chi(source, cell * spacing, 0.5f, 1e9);
      const SparseField near = compute_chi(source, cell * spacing, 0.5f, 1e9, &region);
      const TriangleMesh whole = extract_iso_surface(all, 0.5f), part = extract_iso_surface(near, 0.5f);
      const std::vector<double> all_pieces = piece_volumes(whole), found_pieces = piece_volumes(part);
      std::vector<double> missing;
      std::set_difference(all_pieces.begin(), all_pieces.end(), found_pieces.begin(), found_pieces.end(),
                          std::back_inserter(missing));
      ASSERT_EQ(found_pieces.size() + missing.size(), all_pieces.size()) << "seed " << seed << " cell " << cell;
      for (const double v : missing) ASSERT_TRUE(v < 0.0 && v > -0.1 * std::pow(spacing, 3)) << v;
      n_missing += missing.size();
      n_left_out += all.n_blocks() - near.n_blocks();
    }
  }
  EXPECT_GT(n_left_out, 300u);
  EXPECT_LE(n_missing, 3u);
}

TEST(SurfaceRegion, FluidIsDeepAndItsSurfaceIsNot) {
  std::mt19937 random(1);
  const std::vector<Vec3> x = make_fluid(random, 20, 1.0, 0.1, [](const Vec3&) { return true; });
  const ParticleBins bins = sort_into_bins(x, 2.0);
  const SurfaceRegion region = find_surface_region(bins, std::vector<float>(x.size(), 1.0f), 1.0);
  EXPECT_FALSE(region.touches_surface({Vec3::Constant(5.0), Vec3::Constant(14.0)}));
  EXPECT_TRUE(region.touches_surface({Vec3(5, 5, -1), Vec3(14, 14, 5)}));
  EXPECT_TRUE(region.touches_surface({Vec3::Constant(40.0), Vec3::Constant(50.0)})) << "where nothing is";
}

/// Measured: lattices to 0.1 %, shaken by 0.25 spacings to 1 %; a sheet to its nearest neighbours.
TEST(EstimateSpacing, FindsTheSpacingOfFluids) {
  std::mt19937 random(3);
  const double spacing = 0.0123;
  const auto estimate = [&](double shaken) {
    return estimate_spacing(make_fluid(random, 18, spacing, shaken, [](const Vec3&) { return true; })) / spacing;
  };
  EXPECT_NEAR(estimate(0.0), 1.0, 0.01);
  EXPECT_NEAR(estimate(0.1), 1.0, 0.01);
  EXPECT_NEAR(estimate(0.25), 1.0, 0.02);
  EXPECT_NEAR(
      estimate_spacing(make_fluid(random, 30, spacing, 0.0, [](const Vec3& x) { return x[1] == 0.0; })) / spacing, 1.0,
      0.01);
}

/// Strays do not change it, nor what it costs: bins as wide as the way to them would hold all the others at once.
TEST(EstimateSpacing, AStrayParticleFarAwayChangesNothing) {
  std::mt19937 random(4);
  const double spacing = 0.01;
  std::vector<Vec3> x = make_fluid(random, 60, spacing, 0.1, [](const Vec3&) { return true; });
  const double alone = estimate_spacing(x);
  for (const Vec3& stray : {Vec3(0, 9000, 0), Vec3(-8000, 50, 3), Vec3(1, 2, 7000)}) x.push_back(stray);
  EXPECT_NEAR(estimate_spacing(x) / alone, 1.0, 1e-4);
}

TEST(EstimateSpacing, TheMedianIsThatOfAllPairs) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(0.0, 1.0);
  std::vector<Vec3> x(400);
  for (Vec3& p : x) p = Vec3(place(random), 1e-3 * place(random), 1e-3 * place(random));
  std::vector<double> nearest(x.size(), 1e300);
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = 0; j < x.size(); ++j)
      if (i != j) nearest[i] = std::min(nearest[i], (x[i] - x[j]).norm());
  std::nth_element(nearest.begin(), nearest.begin() + 199, nearest.end());
  // Of a thread, in which a wider kernel finds less, the estimate is the median itself.
  EXPECT_DOUBLE_EQ(estimate_spacing(x), nearest[199]);
}

TEST(EstimateSpacing, RefusesWhatHasNone) {
  std::vector<Vec3> doubled(200000, Vec3::Ones());
  for (std::size_t i = 0; i < doubled.size(); i += 3) doubled[i][0] = 1e-4 * static_cast<double>(i);
  EXPECT_THROW(estimate_spacing(doubled), Error) << "two thirds at one place";

  EXPECT_THROW(estimate_spacing(std::vector<Vec3>(1, Vec3::Zero())), Error);
  EXPECT_THROW(estimate_spacing(std::vector<Vec3>(100, Vec3::Ones())), Error);
  std::vector<Vec3> x(9, Vec3::Ones());
  x[4][2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(estimate_spacing(x), Error);
}

}  // namespace
}  // namespace smelt
