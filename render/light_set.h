#pragma once
// All lights of a scene: one of them chosen, and how likely that was.

#include "render/environment.h"
#include "render/glow_light.h"
#include "render/light.h"
#include "render/sky.h"

#include <optional>
#include <span>
#include <vector>

namespace smelt {

/// A direction towards some light, seen from a point.
struct LightSample {
  Vec3f direction = Vec3f::UnitY();    ///< unit, towards the light
  float distance = 0.0f;               ///< [m]; infinite for what is far away
  Vec3f radiance = Vec3f::Zero();      ///< zero: the light does not shine on this point; of a `glow` not filled in
  float pdf = 0.0f;                    ///< density of the direction over this light, times the chance to choose it
                                       ///< [1/sr]; of a `glow` the chance alone
  std::optional<MeshPoint> glow = {};  ///< on the glowing surface; direction and distance are left to the caller
};

/// What a ray meets among the lamps.
struct LampHit {
  float distance = std::numeric_limits<float>::infinity();
  Vec3f radiance = Vec3f::Zero();
};

/// Weight of one of two ways to draw the same direction [Veach 1997, eq. 9.13 with beta = 2].
inline float power_heuristic(float mine, float other) {
  return mine * mine / (mine * mine + other * other);
}

/// Lamps, sun, environment and glowing fluid are drawn; the Sky, smooth as it is, is left to rays that happen to go
/// there. Radiance functions that take `pdf`, the density with which the ray's direction was drawn, weigh by the power
/// heuristic what sample() could have drawn too.
class LightSet {
 public:
  LightSet(const RenderScene& scene, const Vec3& origin, GlowLight glow);

  /// Whether sample() has anything to choose from.
  bool any() const { return !lamps_.empty() || sun_ || environment_ || !glow_.empty(); }
  /// Whether the gradient sky shines.
  bool has_sky() const { return !environment_; }

  /// Chooses a light in proportion to what it would send unshadowed, roughly, and a point on it.
  LightSample sample(const Vec3f& point, Sample2 where, float which) const;

  /// The nearest lamp on the ray from `point`.
  LampHit nearest_lamp(const Vec3f& point, const Vec3f& direction, float pdf) const;
  /// Radiance from far away along the ray from `point`.
  Vec3f far_radiance(const Vec3f& point, const Vec3f& direction, float pdf) const;
  /// The same, all of it: for a ray that nothing else competes with.
  Vec3f far_radiance(const Vec3f& direction) const;
  /// The Sky alone, black where an environment takes its place.
  Vec3f sky(const Vec3f& direction) const;
  /// Chance [1/sr] that sample() from `point` yields the direction to this place of the glowing surface; `cosine` is
  /// between the ray and the normal there.
  float glow_pdf(const Vec3f& point, std::uint32_t triangle, float distance, float cosine) const;
  /// The same by area [1/m^2], without the chance to choose the glow.
  float glow_pdf_area(std::uint32_t triangle) const { return glow_.pdf_area(triangle); }
  bool has_glow() const { return !glow_.empty(); }

 private:
  float total_weight(const Vec3f& point) const;
  float lamp_pdf(const LampGeometry& lamp, const Vec3f& point, const Vec3f& direction, float distance) const;

  /// The sun as a cone of directions.
  struct SunCone {
    Vec3f direction;
    float one_minus_cos;  ///< of its angular radius, which is too small for the cosine itself
    float solid_angle;    ///< [sr]
    Vec3f radiance;
    float weight;
    bool contains(const Vec3f& d) const;
  };

  Sky sky_;
  std::vector<LampGeometry> lamps_;
  std::optional<SunCone> sun_;
  std::optional<EnvironmentMap> environment_;
  float environment_weight_ = 0.0f;
  GlowLight glow_;
};

}  // namespace smelt
