#pragma once
// Where the rigid bodies of a frame are: a small JSON file beside its particles, so that pictures, and other programs,
// need nothing else.

#include "core/geometry/pose.h"

#include <filesystem>
#include <string>
#include <vector>

namespace smelt {

/// One rigid body of a frame.
struct BodyPose {
  int collider = 0;                      ///< which [[collider]] of the scene, from 0
  Pose<3> pose;                          ///< from where the scene places its mesh
  Vec3 centre = Vec3::Zero();            ///< of mass [m]
  Vec3 velocity = Vec3::Zero();          ///< of that [m/s]
  Vec3 angular_velocity = Vec3::Zero();  ///< [rad/s]
};

/// {"frame", "time_s", "bodies": [{"collider", "rotation" (rows), "translation_m", "centre_m", "velocity_m_s",
/// "angular_velocity_rad_s"}]}; numbers read back as the same bits. Atomic. Throws Error.
void write_body_poses(const std::filesystem::path& path, int frame, double time, const std::vector<BodyPose>& bodies);

/// Throws Error with the path where the file is missing or not one of these.
std::vector<BodyPose> read_body_poses(const std::filesystem::path& path);

}  // namespace smelt
