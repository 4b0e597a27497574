#include "render/light_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

namespace smelt {
namespace {

RenderScene two_lamps() {
  RenderScene scene;
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
  scene.lights = {square, disk};
  scene.sky = {Vec3f::Zero(), Vec3f::Zero(), Vec3f::Zero()};
  return scene;
}

const Vec3f point(0.1f, 0.0f, -0.2f);

/// Irradiance at `point`, facing up, by drawing lights.
Vec3 drawn_irradiance(const LightSet& lights) {
  Vec3 sum = Vec3::Zero();
  constexpr int n = 256;
  for (int i = 0; i < n * n; ++i) {
    const PixelSampler random(i % n, i / n, 0, 1, 3);
    const LightSample s = lights.sample(point, random.draw(0), random.draw(1).u);
    if (s.pdf > 0.0f) sum += (s.radiance * (std::max(0.0f, s.direction.y()) / s.pdf)).cast<double>() / (n * n);
  }
  return sum;
}

/// The same by rays in all directions: to the sky, the environment and the sun.
Vec3 gathered_irradiance(const LightSet& lights) {
  Vec3 sum = Vec3::Zero();
  constexpr int n = 1000;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const Vec3f d =
          sample_cosine_hemisphere({(static_cast<float>(i) + 0.5f) / n, (static_cast<float>(j) + 0.5f) / n});
      sum += lights.far_radiance(Frame(Vec3f::UnitY()).to_world(d)).cast<double>() * (std::numbers::pi / (n * n));
    }
  return sum;
}

/// With pdf -> 0 for the ray, the power heuristic leaves nothing to it; with pdf -> infinity all.
TEST(Light, RayAndDrawingShareALampByTheirDensities) {
  const LightSet lights(two_lamps(), Vec3::Zero(), {});
  for (int i = 0; i < 256; ++i) {
    const PixelSampler random(i, 0, 0, 1, 3);
    const LightSample s = lights.sample(point, random.draw(0), random.draw(1).u);
    ASSERT_GT(s.pdf, 0.0f);
    const LampHit hit = lights.nearest_lamp(point, s.direction, s.pdf);
    EXPECT_NEAR(hit.distance, s.distance, 1e-3f);
    // Equal densities share equally.
    EXPECT_NEAR(hit.radiance.x(), 0.5f * s.radiance.x(), 2e-3f * s.radiance.x());
  }
}

TEST(Light, IrradianceMatchesTheIntegralOverTheLamps) {
  const RenderScene scene = two_lamps();
  double expected = 0.0;
  constexpr int n = 256;
  for (const AreaLight& light : scene.lights) {
    const LampGeometry lamp = place_lamp(light, Vec3::Zero());
    for (int i = 0; i < n * n; ++i) {
      const Vec3f d =
          sample_lamp(lamp, {(static_cast<float>(i % n) + 0.5f) / n, (static_cast<float>(i / n) + 0.5f) / n}) - point;
      const float distance = d.norm();
      expected += lamp.radiance.x() * lamp.area * (d.y() / distance) * (-d.dot(lamp.normal) / distance) /
                  (distance * distance) / (n * n);
    }
  }
  EXPECT_NEAR(drawn_irradiance(LightSet(scene, Vec3::Zero(), {})).x(), expected, 2e-3 * expected);
}

/// Irradiance of a sun at elevation e: radiance times solid angle times sin e.
TEST(Light, SunIsADiskOfItsSolidAngle) {
  RenderScene scene = two_lamps();
  scene.lights.clear();
  scene.sun = Sun{Vec3(1.0, 1.0, 0.0), 0.2666, Vec3f::Constant(1e4f)};
  const double radius = 0.2666 * std::numbers::pi / 180.0;
  const double expected = 1e4 * std::numbers::pi * radius * radius * std::sqrt(0.5);
  EXPECT_NEAR(drawn_irradiance(LightSet(scene, Vec3::Zero(), {})).x(), expected, 1e-3 * expected);
}

/// A dim sky with a bright patch: drawn in proportion, and gathered by rays everywhere, the same comes in.
TEST(Light, EnvironmentIsDrawnAsItShines) {
  auto image = std::make_shared<RadianceImage>();
  image->width = 32;
  image->height = 16;
  image->pixels.assign(32 * 16, Vec3f(0.2f, 0.3f, 0.5f));
  image->pixels[5 * 32 + 9] = Vec3f::Constant(200.0f);
  RenderScene scene = two_lamps();
  scene.lights.clear();
  scene.environment = Environment{image, 30.0, 2.0f};
  const LightSet lights(scene, Vec3::Zero(), {});
  const Vec3 drawn = drawn_irradiance(lights), gathered = gathered_irradiance(lights);
  EXPECT_LT((drawn - gathered).cwiseAbs().maxCoeff(), 5e-3 * gathered.maxCoeff());
}

TEST(EnvironmentMap, MiddleOfTheImageIsTowardsMinusZ) {
  auto image = std::make_shared<RadianceImage>();
  image->width = 64;
  image->height = 32;
  image->pixels.assign(64 * 32, Vec3f::Zero());
  for (int x = 30; x < 34; ++x)
    image->pixels[static_cast<std::size_t>(16 * 64 + x)] = image->pixels[static_cast<std::size_t>(15 * 64 + x)] =
        Vec3f::Ones();
  EXPECT_GT(EnvironmentMap({image, 0.0, 1.0f}).radiance(-Vec3f::UnitZ()).x(), 0.9f);
  // Turned a quarter counter-clockwise, seen from above, -z goes to -x.
  EXPECT_GT(EnvironmentMap({image, 90.0, 1.0f}).radiance(-Vec3f::UnitX()).x(), 0.9f);
  EXPECT_LT(EnvironmentMap({image, 90.0, 1.0f}).radiance(Vec3f::UnitX()).x(), 0.1f);
}

TEST(EnvironmentMap, DensityIntegratesToOne) {
  auto image = std::make_shared<RadianceImage>();
  image->width = 16;
  image->height = 8;
  for (int i = 0; i < 16 * 8; ++i) image->pixels.push_back(Vec3f::Constant(static_cast<float>(i % 5) * 0.3f));
  const EnvironmentMap map({image, 0.0, 1.0f});
  double sum = 0.0;
  constexpr int n = 400;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      const double theta = std::numbers::pi * (i + 0.5) / n, phi = std::numbers::pi * (j + 0.5) / n,
                   sine = std::sin(theta);
      const Vec3 d(sine * std::cos(phi), std::cos(theta), sine * std::sin(phi));
      sum += map.pdf(d.cast<float>()) * sine * std::numbers::pi * std::numbers::pi / (n * n);
    }
  EXPECT_NEAR(sum, 1.0, 5e-3);
}

TEST(Light, ShinesFromOneSideOnly) {
  const LampGeometry lamp = place_lamp(two_lamps().lights[0], Vec3::Zero());
  EXPECT_FALSE(intersect_lamp(lamp, Vec3f(0.0f, 3.0f, 0.0f), Vec3f(0.0f, -1.0f, 0.0f)));
  EXPECT_TRUE(intersect_lamp(lamp, Vec3f(0.0f, 1.0f, 0.0f), Vec3f(0.0f, 1.0f, 0.0f)));
}

}  // namespace
}  // namespace smelt
