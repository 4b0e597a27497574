#include "core/geometry/motion.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace smelt {
namespace {

constexpr double pi = std::numbers::pi;

Mat3 about(const Vec3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

/// A thing that is tipped, lifted and turned round between three keyframes.
Motion<3> make_tumble(bool smooth) {
  Motion<3> motion;
  motion.pivot = Vec3(0.3, -0.2, 0.5);
  motion.smooth = smooth;
  motion.keyframes = {{0.5, Vec3(0, 0, 0), Mat3::Identity()},
                      {1.0, Vec3(0.2, 0.1, 0), about(Vec3(1, 2, 0), 1.2)},
                      {3.0, Vec3(0.2, 0.4, -0.3), about(Vec3(0, 1, 1), -2.0)}};
  return motion;
}

TEST(Pose, SkewAndRotationAreInverse) {
  const Vec3 omega(0.3, -1.1, 0.7);
  EXPECT_NEAR((to_skew(omega) * Vec3(1, 2, 3) - omega.cross(Vec3(1, 2, 3))).norm(), 0.0, 1e-15);
  EXPECT_NEAR((rotation_of<3>(to_skew(omega)) - about(omega, omega.norm())).norm(), 0.0, 1e-15);
  EXPECT_NEAR((from_skew(skew_of<3>(rotation_of<3>(to_skew(omega)))) - omega).norm(), 0.0, 1e-14);
  EXPECT_NEAR((rotation_of<2>(to_skew(pi / 2.0)) * Vec<2>(1, 0) - Vec<2>(0, 1)).norm(), 0.0, 1e-15);
  EXPECT_NEAR(skew_of<2>(rotation_of<2>(to_skew(-2.5)))(1, 0), -2.5, 1e-15);
}

TEST(Motion, PassesThroughItsKeyframesAndIsHeldBeyondThem) {
  for (const bool smooth : {false, true}) {
    const Motion<3> motion = make_tumble(smooth);
    for (const auto& key : motion.keyframes) {
      const Pose<3> pose = pose_at(motion, key.time);
      EXPECT_NEAR((pose.rotation - key.rotation).norm(), 0.0, 1e-14);
      EXPECT_NEAR((pose.to_world(motion.pivot) - motion.pivot - key.translation).norm(), 0.0, 1e-15);
    }
    EXPECT_EQ(pose_at(motion, -4.0).translation, pose_at(motion, 0.5).translation);
    EXPECT_EQ(pose_at(motion, 99.0).rotation, pose_at(motion, 3.0).rotation);
    for (const double t : {0.2, 3.5}) {
      EXPECT_EQ(twist_at(motion, t).spin.norm(), 0.0);
      EXPECT_EQ(twist_at(motion, t).velocity.norm(), 0.0);
      EXPECT_EQ(speed_bound(motion, t, t + 0.1, 1.0), 0.0);
    }
  }
}

// Halfway in time, a slerp is halfway round.
TEST(Motion, TurnsAtAnEvenRateByTheShorterWay) {
  Motion<3> motion;
  motion.keyframes = {{0.0, Vec3::Zero(), about(Vec3(0, 0, 1), -3.0)}, {1.0, Vec3::Zero(), about(Vec3(0, 0, 1), 3.0)}};
  const double way = 6.0 - 2.0 * pi;  // back through half a turn
  for (const double s : {0.25, 0.5, 0.9})
    EXPECT_NEAR((pose_at(motion, s).rotation - about(Vec3(0, 0, 1), -3.0 + s * way)).norm(), 0.0, 1e-13);
}

// Velocity and acceleration of a point fixed to the thing are the derivatives of its place.
TEST(Motion, DerivativesAreThoseOfTheWay) {
  Motion<3> spinning;
  spinning.pivot = Vec3(1, 0, 2);
  spinning.velocity = Vec3(0.1, 0.2, -0.4);
  spinning.spin = to_skew(Vec3(2.0, -1.0, 0.5));
  for (const Motion<3>& motion : {make_tumble(false), make_tumble(true), spinning}) {
    constexpr double h = 1e-4;
    const Vec3 point(1.0, 0.4, -0.8);
    const auto at = [&](double t) { return pose_at(motion, t).to_world(point); };
    for (const double t : {0.61, 0.93, 1.7, 2.8}) {
      EXPECT_NEAR((twist_at(motion, t).at(at(t)) - (at(t + h) - at(t - h)) / (2.0 * h)).norm(), 0.0, 1e-6);
      EXPECT_NEAR((acceleration_at(motion, t).at(at(t)) - (at(t + h) - 2.0 * at(t) + at(t - h)) / (h * h)).norm(), 0.0,
                  1e-5);
      EXPECT_LE(twist_at(motion, t).at(at(t)).norm(),
                speed_bound(motion, t, t, (point - motion.pivot).norm()) * (1.0 + 1e-12));
    }
  }
}

// A step that runs into a faster stretch knows it.
TEST(Motion, SpeedBoundLooksAhead) {
  Motion<2> motion;
  motion.keyframes = {{0.0, Vec<2>(0, 0), Mat<2>::Identity()},
                      {1.0, Vec<2>(1, 0), Mat<2>::Identity()},
                      {1.1, Vec<2>(2, 0), Mat<2>::Identity()}};
  EXPECT_NEAR(speed_bound(motion, 0.2, 0.9, 1.0), 1.0, 1e-12);
  EXPECT_NEAR(speed_bound(motion, 0.2, 1.05, 1.0), 10.0, 1e-9);
  motion.smooth = true;
  EXPECT_NEAR(speed_bound(motion, 0.2, 0.9, 1.0), 1.5, 1e-12);
}

}  // namespace
}  // namespace smelt
