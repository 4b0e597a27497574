#include "render/camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace smelt {
namespace {

TEST(CameraFrame, RaysThroughCentreAndEdges) {
  Camera camera;
  camera.eye = Vec3(1.0, 2.0, 3.0);
  camera.target = Vec3(1.0, 2.0, -7.0);
  camera.vertical_fov_deg = 90.0;
  camera.width = 200;
  camera.height = 100;
  const CameraFrame frame(camera);
  // A right angle from bottom to top: the top edge is 45 degrees up; the picture is twice as wide as high.
  EXPECT_LT((frame.direction(100, 50) - Vec3f(0, 0, -1)).norm(), 1e-6f);
  EXPECT_LT((frame.direction(100, 0) - Vec3f(0, 1, -1).normalized()).norm(), 1e-6f);
  EXPECT_LT((frame.direction(200, 50) - Vec3f(2, 0, -1).normalized()).norm(), 1e-6f);
  EXPECT_LT((frame.direction(0, 100) - Vec3f(-2, -1, -1).normalized()).norm(), 1e-6f);
}

TEST(CameraFrame, UpNeedsNoRightAngle) {
  Camera camera;
  camera.eye = Vec3(0.0, 1.0, 1.0);
  camera.target = Vec3::Zero();
  const CameraFrame frame(camera);
  EXPECT_NEAR(frame.up.dot(frame.forward), 0.0, 1e-12);
  EXPECT_NEAR(frame.right.x(), 1.0, 1e-12);
  EXPECT_NEAR(frame.up.y(), std::sqrt(0.5), 1e-12);
}

}  // namespace
}  // namespace smelt
