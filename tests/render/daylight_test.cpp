#include "render/daylight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace smelt {
namespace {

Daylight at_elevation(double degrees) {
  const double e = degrees * std::numbers::pi / 180.0;
  return {Vec3(std::cos(e), std::sin(e), 0.0), 1.0};
}

Vec3f towards(const RadianceImage& sky, double elevation_deg) {
  const int row = static_cast<int>((0.5 - elevation_deg / 180.0) * sky.height);
  return sky.pixels[static_cast<std::size_t>(row) *
                    static_cast<std::size_t>(sky.width)];  // away from the sun, towards -x .. +z
}

TEST(Daylight, ZenithIsBlueAndTheSunReddensAsItSinks) {
  const RadianceImage noon = make_sky(at_elevation(60.0), 64, 32);
  const Vec3f zenith = towards(noon, 85.0);
  EXPECT_GT(zenith.z(), 2.0f * zenith.x());
  const Sun high = make_sun(at_elevation(60.0)), low = make_sun(at_elevation(3.0));
  EXPECT_GT(low.radiance.x() / low.radiance.z(), 2.0f * high.radiance.x() / high.radiance.z());
  EXPECT_LT(low.radiance.sum(), 0.7f * high.radiance.sum());
  EXPECT_TRUE(make_sun(at_elevation(-3.0)).radiance.isZero(0.0f));
}

/// Rayleigh's optical depth at 550 nm from sea level is 8000 m times 13.5e-6 / m, 0.108; straight up.
TEST(Daylight, SunIsDimmedByTheOpticalDepth) {
  const Sun sun = make_sun({Vec3::UnitY(), 0.1});
  const double radius = 0.2666 * std::numbers::pi / 180.0, solid_angle = std::numbers::pi * radius * radius;
  const double expected = 1.2 * std::numbers::pi * std::exp(-0.108 * std::exp(-100.0 / 8000.0) - 0.0005);
  EXPECT_NEAR(sun.radiance.y() * solid_angle, expected, 0.01 * expected);
}

}  // namespace
}  // namespace smelt
