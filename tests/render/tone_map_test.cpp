#include "render/tone_map.h"

#include <gtest/gtest.h>

namespace smelt {
namespace {

TEST(Srgb, ExactValues) {
  EXPECT_EQ(srgb_from_linear(0.0f), 0.0f);
  EXPECT_NEAR(srgb_from_linear(1.0f), 1.0f, 1e-6f);
  EXPECT_NEAR(srgb_from_linear(0.0031308f), 0.04045f, 1e-5f);
  EXPECT_NEAR(srgb_from_linear(0.5f), 0.735357f, 1e-6f);
  EXPECT_NEAR(srgb_from_linear(0.2140411f), 0.5f, 1e-6f);
  for (const float value : {0.001f, 0.02f, 0.3f, 0.9f}) {
    EXPECT_NEAR(linear_from_srgb(srgb_from_linear(value)), value, 1e-6f);
  }
}

TEST(Quantize, RoundsAndDithersByHalfAStep) {
  const float level_100 = linear_from_srgb(100.0f / 255.0f);
  EXPECT_EQ(quantize_srgb(Vec3f::Constant(level_100), 0.0f)[0], 100);
  EXPECT_EQ(quantize_srgb(Vec3f::Constant(level_100), 0.9f)[1], 100);
  const float level_100_4 = linear_from_srgb(100.4f / 255.0f);
  EXPECT_EQ(quantize_srgb(Vec3f::Constant(level_100_4), 0.9f)[2], 101);
  EXPECT_EQ(quantize_srgb(Vec3f(-1.0f, 2.0f, 1.0f), 0.9f), (std::array<std::uint8_t, 3>{0, 255, 255}));
}

TEST(ToneMap, KeepsWhatDisplaysCanShowAndCompressesTheRest) {
  const Vec3f wax(0.7f, 0.4f, 0.1f);
  EXPECT_EQ(tone_map_neutral(wax), wax);
  float last = 0.0f;
  for (float exposure = 0.1f; exposure < 1000.0f; exposure *= 1.3f) {
    const Vec3f c = tone_map_neutral(wax * exposure);
    EXPECT_GE(c.x(), last);  // monotonic
    EXPECT_LE(c.maxCoeff(), 1.0f);
    EXPECT_GE(c.x() + 1e-6f, c.y());  // hue order stays
    last = c.x();
  }
  EXPECT_GT(tone_map_neutral(wax * 100.0f).y(), 0.9f);  // very bright colours bleach
  EXPECT_EQ(tone_map_neutral(Vec3f(-1.0f, 0.0f, 0.2f)), Vec3f(0.0f, 0.0f, 0.2f));
}

}  // namespace
}  // namespace smelt
