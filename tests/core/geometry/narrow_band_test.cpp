#include "core/geometry/narrow_band.h"

#include "tests/meshes.h"

#include <tbb/global_control.h>

namespace smelt {
namespace {

template <typename Visit>
void visit_voxels(const std::vector<BandBlock>& band, Visit visit) {
  for (const BandBlock& block : band)
    for (int voxel = 0; voxel < 512; ++voxel)
      visit(block, static_cast<std::size_t>(voxel),
            Vec3(block.origin[0] + voxel / 64, block.origin[1] + voxel / 8 % 8, block.origin[2] + voxel % 8));
}

TEST(NarrowBand, HoldsTheDistanceToASphere) {
  constexpr double voxel_size = 0.05, radius = 0.6;
  const Vec3 centre(0.013, -0.2, 5.0);
  const auto band = compute_narrow_band(make_sphere(centre, radius, 5), voxel_size, 3.0f);
  std::size_t n_active = 0, n_expected = 0;
  double worst = 0.0;
  visit_voxels(band, [&](const BandBlock& block, std::size_t voxel, const Vec3& at) {
    const double exact = ((voxel_size * at - centre).norm() - radius) / voxel_size;
    n_expected += std::abs(exact) < 3.0;
    if (block.face[voxel] == BandBlock::outside_band) return;
    ++n_active;
    worst = std::max(worst, std::abs(static_cast<double>(block.distance[voxel]) - exact));
  });
  EXPECT_LT(
      worst,
      0.02);  // The sphere of 12288 triangles deviates by about radius * 2.5e-4 = 0.003 voxels or more at its corners.
  EXPECT_NEAR(static_cast<double>(n_active), static_cast<double>(n_expected), 0.01 * static_cast<double>(n_expected));
  EXPECT_GT(n_active, 10000u);
}

TEST(NarrowBand, WeightsGiveTheNearestPoint) {
  constexpr double voxel_size = 0.4;
  const TriangleMesh bunny = load_asset("bunny.obj");
  visit_voxels(
      compute_narrow_band(bunny, voxel_size, 3.0f), [&](const BandBlock& block, std::size_t voxel, const Vec3& at) {
        if (block.face[voxel] == BandBlock::outside_band) return;
        const auto& t = bunny.triangles[static_cast<std::size_t>(block.face[voxel])];
        const auto [v, w] = block.w[voxel];
        const Vec3& a = bunny.vertices[t[0]];
        const Vec3 nearest = a + double{v} * (bunny.vertices[t[1]] - a) + double{w} * (bunny.vertices[t[2]] - a);
        ASSERT_NEAR((nearest / voxel_size - at).norm(), std::abs(block.distance[voxel]), 1e-5);
      });
}

TEST(NarrowBand, NoFaceIsNearer) {
  // Brute force over the faces of a body with sharp edges, by points scattered on each face.
  const TriangleMesh box = make_box({0.03, 0.05, 0.07}, {0.53, 0.35, 0.27});
  constexpr double voxel_size = 0.05;
  visit_voxels(compute_narrow_band(box, voxel_size, 3.0f),
               [&](const BandBlock& block, std::size_t voxel, const Vec3& at) {
                 const Vec3 x = voxel_size * at;
                 const Vec3 outside = (Vec3(0.03, 0.05, 0.07) - x).cwiseMax(x - Vec3(0.53, 0.35, 0.27));
                 const double exact = outside.cwiseMax(0.0).norm() + std::min(0.0, outside.maxCoeff());
                 if (block.face[voxel] != BandBlock::outside_band) {
                   ASSERT_NEAR(block.distance[voxel] * voxel_size, exact, 1e-7) << x.transpose();
                 } else {
                   ASSERT_GE(std::abs(exact), 3.0 * voxel_size * (1 - 1e-7)) << x.transpose();
                 }
               });
}

TEST(NarrowBand, IsTheSameOnAnyNumberOfThreads) {
  const TriangleMesh sphere = make_sphere(Vec3::Zero(), 1.0, 4);  // Full of ties: symmetric about the voxels.
  std::vector<std::vector<BandBlock>> bands;
  for (const std::size_t n_threads : {1, 2, 4}) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, n_threads);
    bands.push_back(compute_narrow_band(sphere, 0.05, 3.0f));
  }
  for (std::size_t n = 1; n < bands.size(); ++n) {
    ASSERT_EQ(bands[n].size(), bands[0].size());
    for (std::size_t b = 0; b < bands[0].size(); ++b) {
      EXPECT_EQ(bands[n][b].face, bands[0][b].face);
      EXPECT_EQ(bands[n][b].distance, bands[0][b].distance);
    }
  }
}

}  // namespace
}  // namespace smelt
