#include "render/denoise.h"

#include "render/sampling.h"

#include <gtest/gtest.h>

namespace smelt {
namespace {

/// A wall at distance 10, facing the eye.
Film make_wall(int width, int height) {
  Film film(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      write_pixel(film.normal, film.index(x, y), Vec3f(0, 0, 1));
      write_pixel(film.position, film.index(x, y),
                  Vec3f(0.01f * static_cast<float>(x), 0.01f * static_cast<float>(y), -10.0f));
      write_pixel(film.albedo, film.index(x, y), Vec3f::Ones());
    }
  }
  return film;
}

void denoise_light(Film& film) {
  denoise(film.light, film.light_variance, film, film.albedo[1], 1000.0f, {});
}

TEST(Denoise, ConstantLightStays) {
  Film film = make_wall(83, 61);
  for (std::size_t i = 0; i < film.size(); ++i) {
    write_pixel(film.light, i, Vec3f(0.25f, 0.5f, 2.0f));
    film.light_variance[i] = 0.01f * static_cast<float>(i % 7);
  }
  denoise_light(film);
  for (std::size_t i = 0; i < film.size(); ++i) {
    ASSERT_LT((read_pixel(film.light, i) - Vec3f(0.25f, 0.5f, 2.0f)).norm(), 1e-5f) << i;
  }
}

TEST(Denoise, NoiseGoesMeanStays) {
  Film film = make_wall(128, 96);
  double before = 0.0;
  for (std::size_t i = 0; i < film.size(); ++i) {
    const float l = 1.0f + (unit_float(hash_u32(static_cast<std::uint32_t>(i))) - 0.5f);
    write_pixel(film.light, i, Vec3f::Constant(l));
    film.light_variance[i] = 1.0f / 12.0f;
    before += l;
  }
  denoise_light(film);
  double mean = 0.0, square = 0.0;
  for (const float l : film.light[0]) {
    mean += l;
    square += (l - 1.0) * (l - 1.0);
  }
  const auto n = static_cast<double>(film.size());
  EXPECT_NEAR(mean / n, before / n, 5e-3);
  EXPECT_LT(std::sqrt(square / n), 0.289 / 15.0);  // 0.289: deviation of the noise put in
}

/// Left half dark, right half bright, full of noise; `edge` separates the halves in one guide.
template <typename Edge>
float worst_leak(const Edge& edge) {
  Film film = make_wall(64, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const std::size_t i = film.index(x, y);
      write_pixel(film.light, i, Vec3f::Constant(x < 32 ? 0.0f : 1.0f));
      film.light_variance[i] = 1.0f;
      if (x >= 32) edge(film, i);
    }
  }
  denoise_light(film);
  float worst = 0.0f;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      worst = std::max(worst, std::abs(film.light[0][film.index(x, y)] - (x < 32 ? 0.0f : 1.0f)));
    }
  }
  return worst;
}

TEST(Denoise, EdgesOfEachGuideStay) {
  EXPECT_GT(worst_leak([](Film&, std::size_t) {}), 0.3f);  // without a guide they do not
  EXPECT_LT(worst_leak([](Film& f, std::size_t i) { write_pixel(f.normal, i, Vec3f(1, 0, 0)); }), 1e-6f);
  EXPECT_LT(worst_leak([](Film& f, std::size_t i) { f.position[2][i] -= 2.0f; }), 1e-6f);
  EXPECT_LT(worst_leak([](Film& f, std::size_t i) { f.kind[i] = 1.0f; }), 1e-6f);
}

TEST(Denoise, DetailBeyondTheNoiseStays) {
  Film film = make_wall(64, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) write_pixel(film.light, film.index(x, y), Vec3f::Constant(x < 32 ? 0.2f : 1.0f));
  }
  DenoiseOptions options;
  options.first_luminance_level = 0;
  denoise(film.light, film.light_variance, film, film.albedo[1], 1000.0f, options);  // variance 0: all of it is detail
  EXPECT_NEAR(film.light[0][film.index(31, 30)], 0.2f, 1e-5f);
  EXPECT_NEAR(film.light[0][film.index(32, 30)], 1.0f, 1e-5f);
}

}  // namespace
}  // namespace smelt
