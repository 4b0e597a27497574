#include "render/material.h"

#include "render/sky.h"

#include <algorithm>
#include <cmath>

namespace smelt {

float fresnel_dielectric(float cos_incident, float ior) {
  const float c = std::clamp(cos_incident, 0.0f, 1.0f);
  const float g = std::sqrt(ior * ior - 1.0f + c * c);
  const float a = (g - c) / (g + c);
  const float b = (c * (g + c) - 1.0f) / (c * (g - c) + 1.0f);
  return 0.5f * a * a * (1.0f + b * b);
}

float ggx_distribution(const Vec3f& half, float alpha) {
  // Written with the sine, so that a narrow lobe keeps its digits at the pole.
  const float sin2 = half.x() * half.x() + half.y() * half.y();
  const float a2 = alpha * alpha;
  const float t = sin2 + half.z() * half.z() * a2;
  return a2 / (pi_f * t * t);
}

float ggx_lambda(const Vec3f& w, float alpha) {
  const float cos2 = w.z() * w.z();
  const float tan2 = std::max(0.0f, 1.0f - cos2) / std::max(cos2, 1e-12f);
  return 0.5f * (std::sqrt(1.0f + alpha * alpha * tan2) - 1.0f);
}

float ggx_mirror(const Vec3f& wi, const Vec3f& wo, float alpha) {
  if (wi.z() <= 0.0f || wo.z() <= 0.0f) return 0.0f;
  const Vec3f half = (wi + wo).normalized();
  const float masking = 1.0f / (1.0f + ggx_lambda(wi, alpha) + ggx_lambda(wo, alpha));
  return ggx_distribution(half, alpha) * masking / (4.0f * wi.z() * wo.z());
}

float ggx_reflection(const Vec3f& wi, const Vec3f& wo, float alpha, float ior) {
  return ggx_mirror(wi, wo, alpha) * fresnel_dielectric((wi + wo).normalized().dot(wo), ior);
}

Vec3f fresnel_metal(const Vec3f& f0, float cos_incident) {
  const float c = 1.0f - std::clamp(cos_incident, 0.0f, 1.0f), c2 = c * c;
  return f0 + (Vec3f::Ones() - f0) * (c2 * c2 * c);
}

Vec3f multiple_scattering(const CoatAlbedo& mirror, const Vec3f& f0, float cos_out, float roughness) {
  const float e = mirror(cos_out, roughness);
  return Vec3f::Ones() + f0 * ((1.0f - e) / e);
}

Vec3f sample_ggx_visible_normal(const Vec3f& wo, float alpha, Sample2 s) {
  // In the space where the surface is a hemisphere, mirrored directions fill a spherical cap evenly.
  const Vec3f w = Vec3f(alpha * wo.x(), alpha * wo.y(), wo.z()).normalized();
  const float phi = 2.0f * pi_f * s.u;
  const float z = (1.0f - s.v) * (1.0f + w.z()) - w.z();
  const float r = std::sqrt(std::clamp(1.0f - z * z, 0.0f, 1.0f));
  const Vec3f half = Vec3f(r * std::cos(phi), r * std::sin(phi), z) + w;
  return Vec3f(alpha * half.x(), alpha * half.y(), std::max(half.z(), 1e-7f)).normalized();
}

float ggx_reflection_pdf(const Vec3f& wi, const Vec3f& wo, float alpha) {
  if (wi.z() <= 0.0f || wo.z() <= 0.0f) return 0.0f;
  const Vec3f half = (wi + wo).normalized();
  return ggx_distribution(half, alpha) / (4.0f * wo.z() * (1.0f + ggx_lambda(wo, alpha)));
}

CoatAlbedo::CoatAlbedo(float ior) {
  tabulate([ior](float cosine) { return fresnel_dielectric(cosine, ior); });
}

CoatAlbedo CoatAlbedo::perfect_mirror() {
  CoatAlbedo albedo;
  albedo.tabulate([](float) { return 1.0f; });
  return albedo;
}

template <typename Fresnel>
void CoatAlbedo::tabulate(const Fresnel& fresnel) {
  // Many in the polar direction: the tail of GGX that leaves below the horizon is a few per cent of the lobe.
  constexpr int n_around = 32, n_polar = 64, n = n_around * n_polar;
  for (int r = 0; r < n_rough_; ++r) {
    const float alpha = ggx_alpha(static_cast<float>(r) / (n_rough_ - 1));
    for (int c = 0; c < n_cos_; ++c) {
      const float cos_out = std::max(static_cast<float>(c) / (n_cos_ - 1), 1e-3f);
      const Vec3f wo(std::sqrt(1.0f - cos_out * cos_out), 0.0f, cos_out);
      // Mean of F G / G1 over mirrored visible normals.
      double sum = 0.0;
      for (int i = 0; i < n; ++i) {
        const Sample2 s{(static_cast<float>(i % n_around) + 0.5f) / n_around,
                        (static_cast<float>(i / n_around) + 0.5f) / n_polar};
        const Vec3f half = sample_ggx_visible_normal(wo, alpha, s);
        const Vec3f wi = half * (2.0f * half.dot(wo)) - wo;
        if (wi.z() <= 0.0f) continue;
        const float lambda_out = ggx_lambda(wo, alpha);
        sum += fresnel(half.dot(wo)) * (1.0f + lambda_out) / (1.0f + lambda_out + ggx_lambda(wi, alpha));
      }
      table_[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] = static_cast<float>(sum / n);
    }
  }
  // 2 integral of E cos d(cos): exact for the piecewise linear table.
  for (std::size_t r = 0; r < n_rough_; ++r) {
    double sum = 0.0;
    for (std::size_t c = 0; c + 1 < n_cos_; ++c) {
      const double x0 = static_cast<double>(c) / (n_cos_ - 1), x1 = static_cast<double>(c + 1) / (n_cos_ - 1);
      const double e0 = table_[r][c], e1 = table_[r][c + 1];
      sum += (x1 - x0) / 3.0 * (e0 * (2.0 * x0 + x1) + e1 * (x0 + 2.0 * x1));
    }
    average_[r] = static_cast<float>(sum);
  }
}

float CoatAlbedo::operator()(float cos_theta, float roughness) const {
  const float x = std::clamp(cos_theta, 0.0f, 1.0f) * (n_cos_ - 1);
  const float y = std::clamp(roughness, 0.0f, 1.0f) * (n_rough_ - 1);
  const int c = std::min(static_cast<int>(x), n_cos_ - 2);
  const int r = std::min(static_cast<int>(y), n_rough_ - 2);
  const float fx = x - static_cast<float>(c), fy = y - static_cast<float>(r);
  const auto& low = table_[static_cast<std::size_t>(r)];
  const auto& high = table_[static_cast<std::size_t>(r + 1)];
  const auto i = static_cast<std::size_t>(c);
  const float a = low[i] + fx * (low[i + 1] - low[i]);
  const float b = high[i] + fx * (high[i + 1] - high[i]);
  return a + fy * (b - a);
}

float CoatAlbedo::average(float roughness) const {
  const float y = std::clamp(roughness, 0.0f, 1.0f) * (n_rough_ - 1);
  const int r = std::min(static_cast<int>(y), n_rough_ - 2);
  const auto i = static_cast<std::size_t>(r);
  return average_[i] + (y - static_cast<float>(r)) * (average_[i + 1] - average_[i]);
}

Wax blend_look(const Look& look, float temperature) {
  if (std::isnan(temperature)) return look.cold;
  const float t = smooth_step(look.cold_K, look.hot_K, temperature);
  Wax wax;
  wax.base_colour = mix(look.cold.base_colour, look.hot.base_colour, t);
  wax.roughness = look.cold.roughness + t * (look.hot.roughness - look.cold.roughness);
  wax.scatter_m = look.cold.scatter_m + t * (look.hot.scatter_m - look.cold.scatter_m);
  return wax;
}

}  // namespace smelt
