#include "surfacing/kernel_shapes.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace smelt {
namespace {

constexpr double spacing = 0.02, h = spacing;

Mat3 matrix(const KernelShape& s) {
  Mat3 m;
  m << s.m[0], s.m[3], s.m[4], s.m[3], s.m[1], s.m[5], s.m[4], s.m[5], s.m[2];
  return m;
}

/// The shape of each particle in the order given; of those without one that of a ball.
std::vector<KernelShape> shapes_of(const std::vector<Vec3>& x) {
  const ParticleBins bins = sort_into_bins(x, 2.0 * h);
  const std::vector<float> volume(x.size(), static_cast<float>(spacing * spacing * spacing));
  const SurfaceRegion region = find_surface_region(bins, volume, spacing);
  const KernelShapes shapes = compute_kernel_shapes(bins, region, spacing, h);
  std::vector<KernelShape> out(x.size(), isotropic_shape(h));
  for (std::size_t b = 0; b < bins.n_bins(); ++b)
    if (shapes.first[b] != KernelShapes::isotropic)
      for (std::uint32_t j = bins.begin[b]; j < bins.begin[b + 1]; ++j)
        out[bins.index[j]] = shapes.shape[shapes.first[b] + j - bins.begin[b]];
  return out;
}

/// A shaken slab, 4 particles thick, with a thread above it and a lone particle.
std::vector<Vec3> slab() {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> shaken(-0.15 * spacing, 0.15 * spacing);
  std::vector<Vec3> x;
  for (int k = 0; k < 12; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 12; ++i)
        x.push_back(spacing * Vec3(i, j, k) + Vec3(shaken(random), shaken(random), shaken(random)));
  for (int i = 0; i < 12; ++i) x.push_back(spacing * Vec3(i, 9, 6) + Vec3(shaken(random), shaken(random), 0));
  x.push_back(spacing * Vec3(6, 16, 6));
  return x;
}

/// M of the turned particles is the turned M; extents are those of their ellipsoids, weights do not turn.
TEST(KernelShapes, TurnWithTheParticles) {
  const std::vector<Vec3> x = slab();
  const std::vector<KernelShape> before = shapes_of(x);
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0.3, 0.9, -0.2), Vec3(-1, 1, 0.4)}) {
    const Mat3 turn = Eigen::AngleAxisd(0.7 + axis[0], axis.normalized()).toRotationMatrix();
    std::vector<Vec3> turned;
    for (const Vec3& p : x) turned.push_back(turn * p);
    const std::vector<KernelShape> after = shapes_of(turned);
    std::size_t n_flat = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Mat3 expected = turn * matrix(before[i]) * turn.transpose();
      ASSERT_LT((matrix(after[i]) - expected).norm(), 2e-4 * expected.norm()) << i;
      ASSERT_NEAR(after[i].weight / before[i].weight, 1.0f, 2e-4f) << i;
      const Mat3 inverse = matrix(after[i]).inverse();
      for (int a = 0; a < 3; ++a) ASSERT_NEAR(after[i].reach[a], 2.0 * std::sqrt(inverse(a, a)), 1e-4 * h) << i;
      n_flat += (matrix(after[i]) - matrix(isotropic_shape(h))).norm() > 0.1 / (h * h);
    }
    EXPECT_GT(n_flat, x.size() / 3);
  }
}

/// Flat across a surface as the header says; a lone particle is round; a thread has the factor of its middle
/// axis.
TEST(KernelShapes, AreFlatAcrossSurfacesAndRoundAlone) {
  std::vector<Vec3> x;
  for (int k = 0; k < 14; ++k)
    for (int j = 0; j < 10; ++j)
      for (int i = 0; i < 14; ++i) x.push_back(spacing * Vec3(i, j, k));
  x.push_back(spacing * Vec3(6, 20, 6));
  const std::vector<KernelShape> shapes = shapes_of(x);
  const KernelShape& top = shapes[7 + 14 * (9 + 10 * 7)];
  EXPECT_NEAR(1.0 / std::sqrt(top.m[1]) / h, 0.87, 0.01);
  EXPECT_NEAR(1.0 / std::sqrt(top.m[0]) / h, 1.0, 0.03);
  EXPECT_NEAR(top.m[3] * h * h, 0.0, 0.02);
  EXPECT_NEAR(top.weight / std::sqrt(matrix(top).determinant()), 1.0, 1e-4);
  const KernelShape round = isotropic_shape(h), &alone = shapes.back();
  for (int n = 0; n < 6; ++n) EXPECT_NEAR(alone.m[n], round.m[n], 1e-4 * round.m[0]);
  EXPECT_NEAR(alone.weight / round.weight, 1.0f, 1e-5f);
}

}  // namespace
}  // namespace smelt
