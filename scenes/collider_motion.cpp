#include "scenes/collider_motion.h"

#include <Eigen/Geometry>

#include <numbers>

namespace smelt {

Motion<3> to_motion(const ColliderSettings& settings, const TriangleMesh& at_rest) {
  Motion<3> motion;
  motion.velocity = settings.velocity;
  motion.spin = to_skew(settings.angular_velocity);
  motion.pivot =
      settings.pivot.value_or(at_rest.vertices.empty() ? Vec3(Vec3::Zero()) : compute_bounds(at_rest).centre());
  motion.smooth = settings.interpolation == "smooth";
  for (const KeyframeSettings& key : settings.keyframes)
    motion.keyframes.push_back({key.time, key.translate, rotation_from_degrees(key.rotate_deg)});
  return motion;
}

Mat3 rotation_from_degrees(const Vec3& degrees) {
  const Vec3 angles = degrees * (std::numbers::pi / 180.0);
  return (Eigen::AngleAxisd(angles[2], Vec3::UnitZ()) * Eigen::AngleAxisd(angles[1], Vec3::UnitY()) *
          Eigen::AngleAxisd(angles[0], Vec3::UnitX()))
      .toRotationMatrix();
}

TriangleMesh moved(const TriangleMesh& mesh, const Pose<3>& pose) {
  TriangleMesh result = mesh;
  for (Vec3& x : result.vertices) x = pose.to_world(x);
  return result;
}

}  // namespace smelt
