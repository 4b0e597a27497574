#include "render/sampling.h"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

namespace smelt {
namespace {

/// Every box of 2^-a x 2^-b with a + b = log2(n) holds exactly one of the n points.
bool is_net(const std::vector<Sample2>& points) {
  const int bits = std::countr_zero(points.size());
  for (int a = 0; a <= bits; ++a) {
    std::set<std::pair<int, int>> boxes;
    for (const Sample2& p : points) {
      boxes.insert({static_cast<int>(std::ldexp(p.u, a)), static_cast<int>(std::ldexp(p.v, bits - a))});
    }
    if (boxes.size() != points.size()) return false;
  }
  return true;
}

TEST(Sobol, SecondDimensionFollowsItsDirectionNumbers) {
  std::uint32_t direction = 0x80000000U;
  for (int k = 0; k < 32; ++k) {
    EXPECT_EQ(reverse_bits(pascal_transform(1U << k)), direction) << k;
    direction ^= direction >> 1;
  }
}

TEST(PixelSampler, NeighbouringPixelsShareANet) {
  for (const std::uint32_t dimension : {0U, 1U, 7U}) {
    std::vector<Sample2> pixel, square;
    for (int s = 0; s < 16; ++s) pixel.push_back(PixelSampler(13, 7, s, 16, 5).draw(dimension));
    EXPECT_TRUE(is_net(pixel));
    for (int y = 8; y < 16; ++y) {
      for (int x = 16; x < 24; ++x) {
        for (int s = 0; s < 4; ++s) square.push_back(PixelSampler(x, y, s, 4, 5).draw(dimension));
      }
    }
    EXPECT_TRUE(is_net(square));
  }
}

TEST(PixelSampler, SeedsAndDimensionsDiffer) {
  const PixelSampler a(3, 4, 0, 4, 1), b(3, 4, 0, 4, 2);
  EXPECT_NE(a.draw(0).u, b.draw(0).u);
  EXPECT_NE(a.draw(0).u, a.draw(1).u);
  EXPECT_EQ(a.draw(2).v, PixelSampler(3, 4, 0, 4, 1).draw(2).v);
}

TEST(PixelSampler, DimensionsAreUncorrelated) {
  double sum = 0.0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const PixelSampler p(x, y, 0, 1, 9);
      sum += (static_cast<double>(p.draw(1).u) - 0.5) * (static_cast<double>(p.draw(2).u) - 0.5);
    }
  }
  EXPECT_LT(std::abs(sum / 4096.0) * 12.0, 0.06);  // correlation; its deviation for independent numbers is 1/64
}

TEST(Sampling, CosineHemisphereHasItsMoments) {
  double z = 0.0, z2 = 0.0, x2 = 0.0;
  constexpr int n = 256;
  for (int i = 0; i < n * n; ++i) {
    const Vec3f d =
        sample_cosine_hemisphere({(static_cast<float>(i % n) + 0.5f) / n, (static_cast<float>(i / n) + 0.5f) / n});
    ASSERT_NEAR(d.norm(), 1.0f, 1e-5f);
    z += d.z();
    z2 += d.z() * d.z();
    x2 += d.x() * d.x();
  }
  EXPECT_NEAR(z / (n * n), 2.0 / 3.0, 3e-4);  // integral of cos^2 / pi
  EXPECT_NEAR(z2 / (n * n), 0.5, 1e-4);
  EXPECT_NEAR(x2 / (n * n), 0.25, 1e-4);
}

TEST(Sampling, DiffusionRadiusFollowsTheProfile) {
  const float d = 0.02f;
  std::array<int, 3> below{};
  const std::array<float, 3> radii{0.01f, 0.03f, 0.1f};
  constexpr int n = 100000;
  for (int i = 0; i < n; ++i) {
    const float r = sample_diffusion_radius((static_cast<float>(i) + 0.5f) / n, d);
    for (std::size_t k = 0; k < 3; ++k) below[k] += r < radii[k] ? 1 : 0;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const double r = radii[k] / static_cast<double>(d);
    const double expected =
        1.0 - 0.25 * std::exp(-r) - 0.75 * std::exp(-r / 3.0);  // [Christensen and Burley 2015, eq. 11]
    EXPECT_NEAR(below[k] / static_cast<double>(n), expected, 1e-4);
  }
}

TEST(Frame, IsOrthonormalAndRightHanded) {
  for (const Vec3f& axis : {Vec3f(0, 0, 1), Vec3f(0, 0, -1), Vec3f(0.6f, -0.64f, 0.48f)}) {
    const Frame frame(axis);
    EXPECT_NEAR(frame.tangent.dot(frame.bitangent), 0.0f, 1e-6f);
    EXPECT_NEAR((frame.to_local(frame.to_world(Vec3f(0.1f, 0.2f, 0.3f))) - Vec3f(0.1f, 0.2f, 0.3f)).norm(), 0.0f,
                1e-6f);
    EXPECT_NEAR((frame.to_world(Vec3f(0, 0, 1)) - axis).norm(), 0.0f, 1e-6f);
  }
}

}  // namespace
}  // namespace smelt
