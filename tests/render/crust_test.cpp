#include "render/crust.h"

#include "render/sampling.h"
#include "render/texture.h"

#include <gtest/gtest.h>

#include <cmath>

namespace smelt {
namespace {

Vec3f scattered(int i) {
  const auto part = [i](std::uint32_t k) {
    return 40.0f * (unit_float(hash_combine(static_cast<std::uint32_t>(i), k)) - 0.5f);
  };
  return {part(1), part(2), part(3)};
}

TEST(Texture, NoiseIsSmoothBoundedAndEven) {
  double sum = 0.0, square = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3f x = scattered(i);
    const float here = gradient_noise(x);
    EXPECT_LT(std::abs(here), 1.1f);
    EXPECT_LT(std::abs(gradient_noise(x + Vec3f(1e-3f, 0.0f, 0.0f)) - here), 5e-3f);
    sum += here;
    square += here * here;
  }
  EXPECT_NEAR(sum / 20000, 0.0, 0.01);
  EXPECT_GT(square / 20000, 0.02);
}

TEST(Texture, CellsHaveEdgesAndMiddles) {
  float widest = 0.0f;
  int n_edges = 0;
  for (int i = 0; i < 5000; ++i) {
    const CellSample s = cell_noise(scattered(i));
    EXPECT_GE(s.edge, 0.0f);
    widest = std::max(widest, s.edge);
    n_edges += s.edge < 0.05f ? 1 : 0;
    // Within a cell the nearest point stays the same.
    if (s.edge > 0.01f) {
      EXPECT_EQ(cell_noise(scattered(i) + Vec3f(0.0f, 5e-3f, 0.0f)).cell, s.cell);
    }
  }
  EXPECT_GT(widest, 0.3f);
  EXPECT_GT(n_edges, 100);
}

TEST(Crust, CracksAreHotPlatesCoolerAndMoreSoWhereSet) {
  const CrustLook look;
  EXPECT_EQ(crust_cooling(look, 0.0f, 1.0f), 0.0f);
  EXPECT_FLOAT_EQ(crust_cooling(look, 1.0f, 1.0f), look.cooler_K);
  EXPECT_LT(crust_cooling(look, 1.0f, 0.0f), look.cooler_K);
  double set = 0.0, liquid = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const float cover = sample_crust(look, scattered(i), 1.0f).cover;
    EXPECT_GE(cover, 0.0f);
    EXPECT_LE(cover, 1.0f);
    set += cover;
    liquid += sample_crust(look, scattered(i), 0.0f).cover;
  }
  EXPECT_LT(liquid, set);
  EXPECT_GT(set / 4000, 0.5);
}

}  // namespace
}  // namespace smelt
