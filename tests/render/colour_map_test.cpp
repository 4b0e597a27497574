#include "render/colour_map.h"

#include "render/colour_bar.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace smelt {
namespace {

/// Lightness L* of CIE 1976, of a linear colour: another space than the one the map was made in.
double cie_lightness(const Vec3f& rgb) {
  const double y = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
  return y > 0.008856 ? 116.0 * std::cbrt(y) - 16.0 : 903.3 * y;
}

TEST(Oklab, KnownColours) {
  EXPECT_LT((oklab_from_rgb(Vec3::Ones()) - Vec3(1.0, 0.0, 0.0)).norm(), 1e-4);
  // Red, from the definition's own page [Ottosson 2020].
  EXPECT_LT((oklab_from_rgb(Vec3(1.0, 0.0, 0.0)) - Vec3(0.6280, 0.2249, 0.1258)).norm(), 1e-3);
  const Vec3 some(0.2, 0.5, 0.1);
  EXPECT_LT((rgb_from_oklab(oklab_from_rgb(some)) - some).norm(), 1e-9);
}

TEST(ColourMap, EqualStepsLookEqual) {
  const ColourMap map;
  std::vector<double> steps;
  for (int k = 1; k < 64; ++k) {
    const auto lab = [&](int i) { return oklab_from_rgb(map(static_cast<float>(i) / 63.0f).cast<double>()); };
    steps.push_back((lab(k) - lab(k - 1)).norm());
  }
  const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
  EXPECT_LT(*most / *least, 1.1);
}

TEST(ColourMap, LightnessRises) {
  const ColourMap map;
  for (int k = 1; k < 256; ++k)
    EXPECT_GT(cie_lightness(map(static_cast<float>(k) / 255.0f)),
              cie_lightness(map(static_cast<float>(k - 1) / 255.0f)))
        << k;
  EXPECT_GT(cie_lightness(map(1.0f)) - cie_lightness(map(0.0f)), 60.0);
}

TEST(ColourBar, TicksAreRoundAndInside) {
  EXPECT_EQ(compute_ticks({"", 300.0, 400.0, false}, 5).size(), 6U);
  const auto odd = compute_ticks({"", 273.2, 291.7, false}, 6);
  for (const double tick : odd) {
    EXPECT_GE(tick, 273.2);
    EXPECT_LE(tick, 291.7);
    EXPECT_NEAR(tick / 5.0, std::round(tick / 5.0), 1e-9);
  }
  EXPECT_GE(odd.size(), 3U);
  for (const double tick : compute_ticks({"", 30.0, 4e8, true}, 5))
    EXPECT_NEAR(std::log10(tick), std::round(std::log10(tick)), 1e-9);
  EXPECT_NEAR(ColourScale({"", 1.0, 1e4, true}).place(100.0), 0.5, 1e-12);
}

}  // namespace
}  // namespace smelt
