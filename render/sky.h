#pragma once
// Radiance of the sky and of the backdrop by direction.

#include "core/geometry/vec.h"
#include "render/scene_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace smelt {

/// 3t^2 - 2t^3 between the edges, 0 below and 1 above; `lower` < `upper`.
inline float smooth_step(float lower, float upper, float x) {
  const float t = std::clamp((x - lower) / (upper - lower), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

inline Vec3f mix(const Vec3f& a, const Vec3f& b, float t) {
  return a + (b - a) * t;
}

/// Radiance that arrives from the unit direction `d`: steepest at the horizon on either side, flat towards the poles.
inline Vec3f sky_radiance(const Sky& sky, const Vec3f& d) {
  const float up = std::clamp(d.y(), -1.0f, 1.0f);
  return up >= 0.0f ? mix(sky.horizon, sky.zenith, up * (2.0f - up)) : mix(sky.horizon, sky.ground, -up * (2.0f + up));
}

/// What the camera sees in the unit direction `d` where nothing stands.
inline Vec3f backdrop_radiance(const Backdrop& backdrop, const Vec3f& d) {
  const auto height = [](double degrees) { return static_cast<float>(std::sin(degrees * std::numbers::pi / 180.0)); };
  return mix(backdrop.low, backdrop.high, smooth_step(height(backdrop.low_deg), height(backdrop.high_deg), d.y()));
}

}  // namespace smelt
