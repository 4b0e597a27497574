#pragma once
// From pixels to rays.

#include "core/geometry/vec.h"
#include "render/scene_view.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

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
  }

  /// Unit direction through the point (x, y) of the picture in pixels from the top left corner; a pixel's centre is at
  /// +0.5.
  Vec3f direction(double x, double y) const {
    const Vec3 d = forward + right * ((x - half_width_) / pixels_per_x) - up * ((y - half_height_) / pixels_per_x);
    return d.normalized().cast<float>();
  }

 private:
  double half_width_, half_height_;
};

}  // namespace smelt
