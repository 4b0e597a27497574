#pragma once
// From pixels to rays.

#include "core/geometry/vec.h"
#include "render/sampling.h"
#include "render/scene_view.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace smelt {

/// The camera's axes, scaled so that a point of the image plane at distance 1 is forward + x right + y up.
struct CameraFrame {
  Vec3 eye, right, up, forward;
  double pixels_per_x = 1.0;  ///< also the pixels per y: square pixels

  explicit CameraFrame(const Camera& camera)
      : eye(camera.eye),
        right(),
        up(),
        forward((camera.target - camera.eye).normalized()),
        half_width_(0.5 * camera.width),
        half_height_(0.5 * camera.height) {
    const double tan_half = std::tan(0.5 * camera.vertical_fov_deg * std::numbers::pi / 180.0);
    pixels_per_x = half_height_ / tan_half;
    right = forward.cross(camera.up).normalized();
    up = right.cross(forward);
    lens_radius_ = static_cast<float>(0.5 * camera.aperture);
    focus_ =
        static_cast<float>(camera.focus_distance > 0.0 ? camera.focus_distance : (camera.target - camera.eye).norm());
  }

  /// Unit direction through the point (x, y) of the picture in pixels from the top left corner; a pixel's centre is at
  /// +0.5.
  Vec3f direction(double x, double y) const {
    const Vec3 d = forward + right * ((x - half_width_) / pixels_per_x) - up * ((y - half_height_) / pixels_per_x);
    return d.normalized().cast<float>();
  }

  /// Where a point is in the picture, in pixels from the top left corner; nothing where it is behind the eye.
  std::optional<std::pair<double, double>> project(const Vec3& point) const {
    const Vec3 d = point - eye;
    const double depth = d.dot(forward);
    if (!(depth > 0.0)) return std::nullopt;
    return std::pair(half_width_ + d.dot(right) / depth * pixels_per_x,
                     half_height_ - d.dot(up) / depth * pixels_per_x);
  }

  /// A ray through a point of the lens, relative to the eye; `direction` is that through the middle of the lens. Rays
  /// of one `direction` meet on the plane that is sharp.
  struct LensRay {
    Vec3f origin, direction;
  };
  LensRay through_lens(const Vec3f& direction, Sample2 on_lens) const {
    if (lens_radius_ <= 0.0f) return {Vec3f::Zero(), direction};
    const Sample2 d = sample_disk(on_lens);
    const Vec3f origin = lens_radius_ * (d.u * right.cast<float>() + d.v * up.cast<float>());
    const Vec3f sharp = direction * (focus_ / direction.dot(forward.cast<float>()));
    return {origin, (sharp - origin).normalized()};
  }

 private:
  double half_width_, half_height_;
  float lens_radius_ = 0.0f;  ///< [m]
  float focus_ = 1.0f;        ///< [m]
};

}  // namespace smelt
