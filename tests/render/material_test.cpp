#include "render/material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace smelt {
namespace {

Vec3f direction(double cos_theta, double phi) {
  const double s = std::sqrt(1.0 - cos_theta * cos_theta);
  return Vec3(s * std::cos(phi), s * std::sin(phi), cos_theta).cast<float>();
}

/// Integral over the hemisphere of f(wi), midpoint rule in cos(theta) and phi.
template <typename F>
double integrate_hemisphere(const F& f, int n_cos = 400, int n_phi = 800) {
  double sum = 0.0;
  for (int i = 0; i < n_cos; ++i) {
    for (int j = 0; j < n_phi; ++j) sum += f(direction((i + 0.5) / n_cos, 2.0 * std::numbers::pi * (j + 0.5) / n_phi));
  }
  return sum * 2.0 * std::numbers::pi / (n_cos * n_phi);
}

TEST(Fresnel, KnownValues) {
  EXPECT_NEAR(fresnel_dielectric(1.0f, 1.5f), 0.04f, 1e-6f);
  EXPECT_NEAR(fresnel_dielectric(0.0f, 1.5f), 1.0f, 1e-6f);
  // At 60 degrees, n = 1.5: Rs = 0.1773, Rp = 0.0018 (Hecht, Optics, eqs. 4.34 and 4.40).
  EXPECT_NEAR(fresnel_dielectric(0.5f, 1.5f), 0.0892f, 2e-4f);
}

TEST(Ggx, DistributionIsNormalised) {
  for (const float roughness : {0.4f, 0.7f, 1.0f}) {
    const float alpha = ggx_alpha(roughness);
    const double area = integrate_hemisphere([&](const Vec3f& h) { return ggx_distribution(h, alpha) * h.z(); });
    EXPECT_NEAR(area, 1.0, 5e-3);
  }
}

TEST(Ggx, ReflectionIsReciprocal) {
  for (const float roughness : {0.2f, 0.6f, 1.0f}) {
    const Vec3f a = direction(0.3, 0.4), b = direction(0.8, 2.5);
    const float forth = ggx_reflection(a, b, ggx_alpha(roughness), 1.45f);
    EXPECT_GT(forth, 0.0f);
    EXPECT_NEAR(forth, ggx_reflection(b, a, ggx_alpha(roughness), 1.45f), 1e-5f * forth);
  }
}

TEST(Ggx, PdfIntegratesToWhatIsReflectedUpwards) {
  for (const double cos_out : {0.2, 0.9}) {
    const Vec3f wo = direction(cos_out, 0.0);
    const float alpha = ggx_alpha(0.7f);
    const double total = integrate_hemisphere([&](const Vec3f& wi) { return ggx_reflection_pdf(wi, wo, alpha); });
    int n_up = 0;
    constexpr int n = 256;
    for (int i = 0; i < n * n; ++i) {
      const Vec3f h = sample_ggx_visible_normal(
          wo, alpha, {(static_cast<float>(i % n) + 0.5f) / n, (static_cast<float>(i / n) + 0.5f) / n});
      n_up += (h * (2.0f * h.dot(wo)) - wo).z() > 0.0f ? 1 : 0;
    }
    EXPECT_NEAR(total, static_cast<double>(n_up) / (n * n), 5e-3);
  }
}

TEST(CoatAlbedo, MatchesQuadratureOfTheReflection) {
  const CoatAlbedo albedo(1.45f);
  for (const float roughness : {0.45f, 0.8f}) {
    for (const double cos_out : {0.25, 0.6, 0.95}) {
      const Vec3f wo = direction(cos_out, 0.0);
      const double expected = integrate_hemisphere(
          [&](const Vec3f& wi) { return ggx_reflection(wi, wo, ggx_alpha(roughness), 1.45f) * wi.z(); });
      EXPECT_NEAR(albedo(static_cast<float>(cos_out), roughness), expected, 3e-3);
    }
  }
}

TEST(CoatedDiffuse, WhiteBodyAndCoatReflectExactlyAll) {
  const CoatAlbedo albedo(1.45f);
  for (const float roughness : {0.3f, 0.6f, 1.0f}) {
    for (const double cos_out : {0.1, 0.5, 1.0}) {
      const Vec3f wo = direction(cos_out, 0.0);
      const CoatedDiffuse diffuse(albedo, wo.z(), 1.0f, roughness);
      const double body =
          integrate_hemisphere([&](const Vec3f& wi) { return diffuse(albedo, wi.z()) * wi.z() / pi_f; }, 1000, 4);
      EXPECT_NEAR(body + albedo(wo.z(), roughness), 1.0, 2e-3);
    }
  }
}

TEST(CoatedDiffuse, IsReciprocal) {
  const CoatAlbedo albedo(1.45f);
  const float forth = CoatedDiffuse(albedo, 0.3f, 0.7f, 0.4f)(albedo, 0.8f);
  EXPECT_NEAR(forth, CoatedDiffuse(albedo, 0.8f, 0.7f, 0.4f)(albedo, 0.3f), 1e-6f);
}

/// Directional albedo of a metal: at most what arrives; at least what its first reflection and, once more darkened by
/// its colour, all further ones come to, so all of it where the metal is white.
TEST(Metal, ReflectsNoMoreThanArrives) {
  const CoatAlbedo mirror = CoatAlbedo::perfect_mirror();
  for (const Vec3f& f0 : {Vec3f(1.0f, 1.0f, 1.0f), Vec3f(0.95f, 0.64f, 0.54f)})
    for (const float roughness : {0.4f, 0.7f, 1.0f})
      for (const double cos_out : {0.2, 0.6, 1.0}) {
        const Vec3f wo = direction(cos_out, 0.0);
        const Vec3f scale = multiple_scattering(mirror, f0, wo.z(), roughness);
        for (int c = 0; c < 3; ++c) {
          const double albedo = integrate_hemisphere(
              [&](const Vec3f& wi) {
                const Vec3f half = (wi + wo).normalized();
                return ggx_mirror(wi, wo, ggx_alpha(roughness)) * wi.z() * scale[c] *
                       fresnel_metal(f0, half.dot(wo))[c];
              },
              4000, 100);
          EXPECT_LT(albedo, 1.006) << roughness << " " << cos_out;
          const double first = mirror(wo.z(), roughness);
          EXPECT_GT(albedo, 0.98 * f0[c] * (first + f0[c] * (1.0 - first))) << roughness << " " << cos_out;
        }
      }
}

TEST(Metal, FresnelRunsFromItsColourToWhite) {
  const Vec3f gold(1.0f, 0.77f, 0.34f);
  EXPECT_LT((fresnel_metal(gold, 1.0f) - gold).norm(), 1e-6f);
  EXPECT_LT((fresnel_metal(gold, 0.0f) - Vec3f::Ones()).norm(), 1e-6f);
}

TEST(Look, BlendsFromColdToHot) {
  const Look look;
  EXPECT_FLOAT_EQ(blend_look(look, 250.0f).roughness, look.cold.roughness);
  EXPECT_FLOAT_EQ(blend_look(look, 500.0f).roughness, look.hot.roughness);
  EXPECT_NEAR(blend_look(look, 350.0f).roughness, 0.5f * (look.cold.roughness + look.hot.roughness), 1e-6f);
  EXPECT_FLOAT_EQ(blend_look(look, std::numeric_limits<float>::quiet_NaN()).scatter_m, look.cold.scatter_m);
}

}  // namespace
}  // namespace smelt
