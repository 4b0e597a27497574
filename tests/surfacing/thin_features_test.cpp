#include "surfacing/thin_features.h"

#include <gtest/gtest.h>

namespace smelt {
namespace {

std::vector<Vec3> lattice(const Lattice& n) {
  std::vector<Vec3> x;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) x.push_back(Vec3(i, j, k));
  return x;
}

/// Factors by which the particles of spacing 1 are strengthened, in their order.
std::vector<float> factors(const std::vector<Vec3>& x, double h, double iso, double cell) {
  const ParticleBins bins = sort_into_bins(x, 2.0 * h);
  std::vector<float> volume(x.size(), 1.0f), out(x.size());
  const std::vector<float> filling = compute_filling(bins, volume, 2.0);
  strengthen_thin_features(volume, bins, filling, {1.0, h, cell, iso, 1.0});
  for (std::size_t j = 0; j < x.size(); ++j) out[bins.index[j]] = volume[j];
  return out;
}

/// The table of the header.
TEST(ThinFeatures, FillingTellsDropsThreadsSheetsAndBodiesApart) {
  const auto in_the_middle = [](const Lattice& n, double h) {
    const std::vector<Vec3> x = lattice(n);
    const ParticleBins bins = sort_into_bins(x, 2.0 * h);
    const std::vector<float> filling = compute_filling(bins, std::vector<float>(x.size(), 1.0f), h);
    const std::size_t middle = n[0] / 2 + n[0] * (n[1] / 2 + n[1] * static_cast<std::size_t>(n[2] / 2));
    for (std::size_t j = 0; j < x.size(); ++j)
      if (bins.index[j] == middle) return filling[j];
    return -1.0f;
  };
  EXPECT_NEAR(in_the_middle({11, 11, 11}, 1.0), 1.00, 0.01);
  EXPECT_NEAR(in_the_middle({11, 1, 11}, 1.0), 0.70, 0.01);
  EXPECT_NEAR(in_the_middle({11, 1, 1}, 1.0), 0.48, 0.01);
  EXPECT_NEAR(in_the_middle({1, 1, 1}, 1.0), 0.32, 0.01);
  EXPECT_NEAR(in_the_middle({11, 11, 11}, 2.0), 1.00, 0.01);
  EXPECT_NEAR(in_the_middle({11, 1, 11}, 2.0), 0.35, 0.01);
  EXPECT_NEAR(in_the_middle({11, 1, 1}, 2.0), 0.12, 0.01);
  EXPECT_NEAR(in_the_middle({1, 1, 1}, 2.0), 0.04, 0.01);
}

/// chi at the particles of a flat surface is 0.85: below 1.3 times an iso-value of 0.8, and yet no thin feature.
TEST(ThinFeatures, FlatSurfacesStayWhateverTheIsoValueKernelAndCell) {
  const int n = 13;
  for (const double iso : {0.5, 0.8, 0.95})
    for (const double h : {1.0, 2.0})
      for (const double cell : {0.5, 1.5}) {
        const std::vector<float> factor = factors(lattice({n, n, n}), h, iso, cell);
        EXPECT_EQ(factor[n / 2 + n * (n / 2)], 1.0f) << iso << " " << h << " " << cell;
        EXPECT_EQ(factor[n / 2 + n * (n / 2 + n * (n / 2))], 1.0f);
      }
}

TEST(ThinFeatures, UsualSettingsAreThoseOfTheTable) {
  // (0.40/c)^(1/2) alone: chi is above the least everywhere.
  EXPECT_NEAR(factors(lattice({1, 1, 1}), 1.0, 0.5, 0.5)[0], std::sqrt(0.40 / 0.0398), 0.01);
  EXPECT_NEAR(factors(lattice({13, 1, 13}), 1.0, 0.5, 0.5)[6 + 13 * 6], std::sqrt(0.40 / 0.35), 0.01);
}

}  // namespace
}  // namespace smelt
