#include "render/light.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace smelt {

float choice_weight(const LampGeometry& lamp, const Vec3f& point) {
  const Vec3f to_point = point - lamp.centre;
  const float d2 = to_point.squaredNorm() + 0.25f * lamp.area;
  const float facing = std::max(0.05f, to_point.dot(lamp.normal) / std::sqrt(d2));
  return lamp.radiance.sum() * lamp.area * facing / d2;
}

LampGeometry place_lamp(const AreaLight& light, const Vec3& origin) {
  const Vec3 normal = (light.target - light.position).normalized();
  // Level the horizontal side; a lamp that looks straight down lies along x.
  Vec3 u = normal.cross(Vec3::UnitY());
  u = u.norm() < 1e-6 ? Vec3(Vec3::UnitX()) : u.normalized();
  const Vec3 v = u.cross(normal);
  const bool disk = light.shape == LightShape::disk;
  const double height = disk ? light.width : light.height;
  LampGeometry lamp;
  lamp.shape = light.shape;
  lamp.centre = (light.position - origin).cast<float>();
  lamp.normal = normal.cast<float>();
  lamp.half_u = (0.5 * light.width * u).cast<float>();
  lamp.half_v = (0.5 * height * v).cast<float>();
  lamp.area = static_cast<float>(light.width * height * (disk ? std::numbers::pi / 4.0 : 1.0));
  lamp.radiance = light.radiance;
  return lamp;
}

Vec3f sample_lamp(const LampGeometry& lamp, Sample2 s) {
  const Sample2 d = lamp.shape == LightShape::disk ? sample_disk(s) : Sample2{2.0f * s.u - 1.0f, 2.0f * s.v - 1.0f};
  return lamp.centre + lamp.half_u * d.u + lamp.half_v * d.v;
}

std::optional<float> intersect_lamp(const LampGeometry& lamp, const Vec3f& origin, const Vec3f& direction) {
  const float facing = -direction.dot(lamp.normal);
  if (facing <= 1e-6f) return std::nullopt;
  const Vec3f to_centre = lamp.centre - origin;
  const float t = -to_centre.dot(lamp.normal) / facing;
  if (t <= 0.0f) return std::nullopt;
  const Vec3f offset = direction * t - to_centre;
  const float a = offset.dot(lamp.half_u) / lamp.half_u.squaredNorm();
  const float b = offset.dot(lamp.half_v) / lamp.half_v.squaredNorm();
  const bool inside =
      lamp.shape == LightShape::disk ? a * a + b * b <= 1.0f : std::abs(a) <= 1.0f && std::abs(b) <= 1.0f;
  if (!inside) return std::nullopt;
  return t;
}

}  // namespace smelt
