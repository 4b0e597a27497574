#pragma once
// Area lights: points on them, and rays that meet them.

#include "core/geometry/vec.h"
#include "render/sampling.h"
#include "render/scene_view.h"

#include <optional>

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

/// What a lamp can send to a point, roughly: choosing by it costs no bias. Never zero on the lit side of any part of
/// the lamp.
float choice_weight(const LampGeometry& lamp, const Vec3f& point);

}  // namespace smelt
