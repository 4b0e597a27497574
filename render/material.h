#pragma once
// A rough dielectric coat over a diffusing body, and metal, in the frame where the normal is +z.

#include "core/geometry/vec.h"
#include "render/sampling.h"
#include "render/scene_view.h"

#include <array>

namespace smelt {

/// Fraction of unpolarised light that a dielectric reflects [Fresnel]; `cos_incident` in [0, 1], `ior` > 1.
float fresnel_dielectric(float cos_incident, float ior);

/// Density of microfacet normals (GGX), isotropic, width `alpha`; integrates to 1 over the hemisphere with the cosine.
float ggx_distribution(const Vec3f& half, float alpha);

/// Smith's Lambda for GGX; masking of one direction is 1 / (1 + Lambda).
float ggx_lambda(const Vec3f& w, float alpha);

/// Microfacet reflection D F G / (4 cos_i cos_o) [1/sr]; 0 below the horizon. Reciprocal.
float ggx_reflection(const Vec3f& wi, const Vec3f& wo, float alpha, float ior);

/// The same without Fresnel's F: a perfect mirror's.
float ggx_mirror(const Vec3f& wi, const Vec3f& wo, float alpha);

/// Share that a metal of reflectance `f0` at normal incidence reflects [Schlick 1994].
Vec3f fresnel_metal(const Vec3f& f0, float cos_incident);

/// A microfacet normal drawn from those visible from `wo`, by spherical caps [Dupuy and Benyoub 2023].
Vec3f sample_ggx_visible_normal(const Vec3f& wo, float alpha, Sample2 s);

/// Density [1/sr] of the direction that mirrors `wo` about such a normal.
float ggx_reflection_pdf(const Vec3f& wi, const Vec3f& wo, float alpha);

/// Share of light that the coat reflects from direction `cos_theta` [0, 1] at perceptual roughness [0, 1]: the
/// directional albedo of ggx_reflection, tabulated. What it does not reflect enters the body.
class CoatAlbedo {
 public:
  /// A dielectric's.
  explicit CoatAlbedo(float ior);
  /// A perfect mirror's: below 1 by what should have been reflected more than once between microfacets.
  static CoatAlbedo perfect_mirror();
  float operator()(float cos_theta, float roughness) const;
  /// Mean over the hemisphere with the cosine.
  float average(float roughness) const;

 private:
  template <typename Fresnel>
  void tabulate(const Fresnel& fresnel);
  CoatAlbedo() = default;

  static constexpr int n_cos_ = 32;
  static constexpr int n_rough_ = 16;
  std::array<std::array<float, n_cos_>, n_rough_> table_{};
  std::array<float, n_rough_> average_{};
};

/// The diffuse body seen through the coat, divided by albedo/pi: (1 - E(wi)) (1 - E(wo)) / (1 - E_avg)
/// [Kelemen and Szirmay-Kalos 2001, eq. 13]: reciprocal, and with white albedo it and the coat together reflect exactly
/// all. `specular` scales E.
struct CoatedDiffuse {
  float exit = 1.0f;  ///< (1 - E(wo)) / (1 - E_avg)
  float specular = 0.0f;
  float roughness = 1.0f;

  CoatedDiffuse(const CoatAlbedo& albedo, float cos_out, float specular_strength, float coat_roughness)
      : exit((1.0f - specular_strength * albedo(cos_out, coat_roughness)) /
             (1.0f - specular_strength * albedo.average(coat_roughness))),
        specular(specular_strength),
        roughness(coat_roughness) {}

  float operator()(const CoatAlbedo& albedo, float cos_in) const {
    return exit * (1.0f - specular * albedo(cos_in, roughness));
  }
};

/// What a metal reflects beyond ggx_mirror times fresnel_metal by light that meets its microfacets more than once: a
/// factor 1 + F0 (1 - E) / E, E the perfect mirror's albedo [Turquin 2019, eq. 16]. A white metal then reflects all.
Vec3f multiple_scattering(const CoatAlbedo& mirror, const Vec3f& f0, float cos_out, float roughness);

/// The look at one temperature [K]: cold and hot blended by a smooth step; cold where `temperature` is NaN.
Wax blend_look(const Look& look, float temperature);

/// GGX width of a perceptual roughness, never so narrow that a float loses the highlight.
inline float ggx_alpha(float roughness) {
  return std::max(roughness * roughness, 1e-3f);
}

}  // namespace smelt
