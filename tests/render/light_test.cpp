#include "render/light_set.h"

#include <gtest/gtest.h>

#include <array>

namespace smelt {
namespace {

std::array<LampGeometry, 2> two_lamps() {
  AreaLight square;
  square.position = Vec3(0.0, 2.0, 0.0);
  square.target = Vec3::Zero();
  square.width = 1.0;
  square.height = 0.5;
  AreaLight disk;
  disk.shape = LightShape::disk;
  disk.position = Vec3(2.0, 1.0, 0.5);
  disk.target = Vec3::Zero();
  disk.width = 0.8;
  return {place_lamp(square, Vec3::Zero()), place_lamp(disk, Vec3::Zero())};
}

TEST(Light, SampledPointsAreHitAndHaveTheSamePdf) {
  const auto lamps = two_lamps();
  const Vec3f point(0.1f, 0.0f, -0.2f);
  for (int i = 0; i < 256; ++i) {
    const PixelSampler random(i, 0, 0, 1, 3);
    const LightSample s = sample_lights(lamps, point, random.draw(0), random.draw(1).u);
    ASSERT_GT(s.pdf, 0.0f);
    bool found = false;
    for (std::size_t k = 0; k < lamps.size(); ++k) {
      const auto t = intersect_lamp(lamps[k], point, s.direction);
      if (!t || std::abs(*t - s.distance) > 1e-4f) continue;
      found = true;
      EXPECT_NEAR(light_pdf(lamps, k, point, s.direction, *t), s.pdf, 1e-3f * s.pdf);
    }
    EXPECT_TRUE(found);
  }
}

TEST(Light, IrradianceMatchesTheIntegralOverTheLamps) {
  const auto lamps = two_lamps();
  const Vec3f point(0.1f, 0.0f, -0.2f);
  double estimate = 0.0, expected = 0.0;
  constexpr int n = 256;
  for (int i = 0; i < n * n; ++i) {
    const PixelSampler random(i % n, i / n, 0, 1, 3);
    const LightSample s = sample_lights(lamps, point, random.draw(0), random.draw(1).u);
    estimate += s.radiance.x() * std::max(0.0f, s.direction.y()) / s.pdf / (n * n);
    for (const LampGeometry& lamp : lamps) {
      const Vec3f d =
          sample_lamp(lamp, {(static_cast<float>(i % n) + 0.5f) / n, (static_cast<float>(i / n) + 0.5f) / n}) - point;
      const float distance = d.norm();
      expected += lamp.radiance.x() * lamp.area * (d.y() / distance) * (-d.dot(lamp.normal) / distance) /
                  (distance * distance) / (n * n);
    }
  }
  EXPECT_NEAR(estimate, expected, 2e-3 * expected);
}

TEST(Light, ShinesFromOneSideOnly) {
  const auto lamps = two_lamps();
  EXPECT_FALSE(intersect_lamp(lamps[0], Vec3f(0.0f, 3.0f, 0.0f), Vec3f(0.0f, -1.0f, 0.0f)));
  EXPECT_TRUE(intersect_lamp(lamps[0], Vec3f(0.0f, 1.0f, 0.0f), Vec3f(0.0f, 1.0f, 0.0f)));
}

}  // namespace
}  // namespace smelt
