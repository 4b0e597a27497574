#pragma once
// Area lights: points on them, what they send, how likely they are chosen.

#include "core/geometry/vec.h"
#include "render/sampling.h"
#include "render/scene_view.h"

#include <optional>
#include <span>

namespace smelt {

/// An AreaLight ready for sampling, relative to the renderer's origin.
struct LampGeometry {
  LightShape shape = LightShape::rectangle;
  Vec3f centre, normal;  ///< `normal` points to the lit side
  Vec3f half_u, half_v;  ///< half the sides, or the disk's radii
  float area = 0.0f;     ///< [m^2]
  Vec3f radiance;
};

LampGeometry place_lamp(const AreaLight& light, const Vec3& origin);

/// A point of the lamp, uniform by area.
Vec3f sample_lamp(const LampGeometry& lamp, Sample2 s);

/// Distance along the ray (unit `direction`) to the lamp's lit face, if the ray meets it.
std::optional<float> intersect_lamp(const LampGeometry& lamp, const Vec3f& origin, const Vec3f& direction);

/// A direction towards some lamp, seen from a point.
struct LightSample {
  Vec3f direction = Vec3f::UnitY();  ///< unit, towards the lamp
  float distance = 0.0f;             ///< [m]
  Vec3f radiance = Vec3f::Zero();    ///< zero: the lamp does not light this point
  float pdf = 0.0f;                  ///< density of the direction over all lamps [1/sr]
};

/// Chooses one lamp, in proportion to what its centre would send unshadowed, and a point on it.
LightSample sample_lights(std::span<const LampGeometry> lamps, const Vec3f& point, Sample2 where, float which);

/// Density [1/sr] with which sample_lights, from `point`, yields the direction that meets lamp `i` at `distance`.
float light_pdf(std::span<const LampGeometry> lamps, std::size_t i, const Vec3f& point, const Vec3f& direction,
                float distance);

}  // namespace smelt
