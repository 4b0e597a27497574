#include "render/black_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace smelt {
namespace {

TEST(Planck, PeakIsWhereWienSays) {
  for (const double kelvin : {800.0, 1400.0, 5778.0}) {
    double best = 0.0, at = 0.0;
    for (double nm = 100.0; nm < 10000.0; nm += 0.25)
      if (const double b = planck_radiance(nm * 1e-9, kelvin); b > best) {
        best = b;
        at = nm * 1e-9;
      }
    EXPECT_NEAR(at * kelvin, 2.897771955e-3, 2.897771955e-3 * 5e-4) << kelvin;
  }
}

/// pi times the integral over all wavelengths is sigma T^4.
TEST(Planck, IntegralIsStefanAndBoltzmanns) {
  for (const double kelvin : {1000.0, 3000.0}) {
    double sum = 0.0;
    const int n = 20000;  // midpoint rule in the logarithm of the wavelength
    const double low = std::log(1e-7), high = std::log(1e-3), step = (high - low) / n;
    for (int k = 0; k < n; ++k) {
      const double wavelength = std::exp(low + (k + 0.5) * step);
      sum += planck_radiance(wavelength, kelvin) * wavelength * step;
    }
    const double expected = 5.670374419e-8 * std::pow(kelvin, 4.0);
    EXPECT_NEAR(std::numbers::pi * sum, expected, 1e-4 * expected);
  }
}

/// Radiance at 1 micrometre and 1000 K: c1L / lambda^5 / (e^14.3878 - 1) with c1L = 1.191043e-16 W m^2 / sr.
TEST(Planck, KnownValue) {
  EXPECT_NEAR(planck_radiance(1e-6, 1000.0), 1.191043e-16 / 1e-30 / std::expm1(14.387769), 1e8 * 1e-4);
}

/// CIE 1931, the 5 nm table of the standard.
TEST(CieMatching, MeetsTheStandardsTable) {
  struct Row {
    double nm;
    Vec3 xyz;
  };
  for (const Row& row :
       {Row{450, {0.3362, 0.0380, 1.7721}}, Row{500, {0.0049, 0.3230, 0.2720}}, Row{555, {0.5121, 1.0000, 0.0057}},
        Row{600, {1.0622, 0.6310, 0.0008}}, Row{650, {0.2835, 0.1070, 0.0000}}})
    EXPECT_LT((cie_matching(row.nm * 1e-9) - row.xyz).cwiseAbs().maxCoeff(), 0.035) << row.nm;
}

/// Until 1979 the candela was 1/60 of what a square centimetre of black body gives off at the freezing point of
/// platinum, 2041.4 K.
TEST(BlackBody, LuminanceAtThePointOfPlatinum) {
  EXPECT_NEAR(black_body_xyz(2041.4)[1], 6.0e5, 6.0e5 * 0.015);
}

/// Chromaticities of the Planckian locus [Wyszecki and Stiles 1982]; illuminant A is 2856 K.
TEST(BlackBody, ChromaticitiesOfThePlanckianLocus) {
  struct Row {
    double kelvin, x, y;
  };
  for (const Row& row : {Row{1000, 0.6528, 0.3444}, Row{1500, 0.5857, 0.3931}, Row{2000, 0.5267, 0.4133},
                         Row{2856, 0.4476, 0.4074}, Row{6500, 0.3135, 0.3237}}) {
    const Vec3 xyz = black_body_xyz(row.kelvin);
    EXPECT_NEAR(xyz[0] / xyz.sum(), row.x, 0.0015) << row.kelvin;
    EXPECT_NEAR(xyz[1] / xyz.sum(), row.y, 0.0015) << row.kelvin;
  }
}

TEST(BlackBody, WhiteOfTheDisplayIsD65) {
  const Vec3 rgb = rgb_from_xyz(Vec3(0.95047, 1.0, 1.08883));
  EXPECT_LT((rgb - Vec3::Ones()).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(BlackBodyTable, MeetsTheIntegral) {
  const BlackBodyTable table;
  const Vec3 weights(0.2126, 0.7152, 0.0722);
  for (const double kelvin : {520.0, 801.0, 1234.0, 1683.0, 2900.0, 6500.0, 15000.0}) {
    const Vec3 xyz = black_body_xyz(kelvin), rgb = table(static_cast<float>(kelvin)).cast<double>();
    EXPECT_NEAR(weights.dot(rgb), xyz[1], 1e-3 * xyz[1]) << kelvin;
    const Vec3 exact = rgb_from_xyz(xyz);
    if (exact.minCoeff() < 0.0) continue;
    EXPECT_LT((rgb - exact).cwiseAbs().maxCoeff(), 2e-3 * exact.maxCoeff()) << kelvin;
  }
}

TEST(BlackBodyTable, GlowsRedAtFirstThenWhiter) {
  const BlackBodyTable table;
  const Vec3f dull = table(900.0f), orange = table(1400.0f);
  EXPECT_GT(dull.minCoeff(), -1e-12f);
  EXPECT_GT(dull[0], 0.0f);
  EXPECT_GT(orange[1] / orange[0], 1.5f * dull[1] / dull[0]);
  EXPECT_TRUE(table(300.0f).isZero(0.0f));
  EXPECT_TRUE(table(std::nanf("")).isZero(0.0f));
}

}  // namespace
}  // namespace smelt
