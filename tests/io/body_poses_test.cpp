#include "io/body_poses.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/checkpoint.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <unistd.h>

namespace smelt {
namespace {

class BodyPoses : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("smelt_body_poses_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

TEST_F(BodyPoses, ReadBackAsTheSameBits) {
  BodyPose body{3,
                {rotation_of<3>(to_skew(Vec3(0.1, 2.0, -0.7))), Vec3(1.0 / 3.0, -1e-17, 5e8)},
                Vec3(0.1, 0.2, 0.3),
                Vec3(1, 2, 3),
                Vec3(-4, 5, 6e-9)};
  write_body_poses(folder_ / "bodies.json", 7, 0.25, {body, BodyPose{}});
  const auto read = read_body_poses(folder_ / "bodies.json");
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].collider, 3);
  EXPECT_EQ(read[0].pose.rotation, body.pose.rotation);
  EXPECT_EQ(read[0].pose.translation, body.pose.translation);
  EXPECT_EQ(read[0].centre, body.centre);
  EXPECT_EQ(read[0].velocity, body.velocity);
  EXPECT_EQ(read[0].angular_velocity, body.angular_velocity);
}

TEST_F(BodyPoses, DamageIsNamed) {
  for (const char* text :
       {"", "{}", "{\"bodies\": [{\"collider\": 0}]}", "{\"bodies\": [{\"collider\": 0, \"rotation\": [[1, 0]]}]}"}) {
    write_file_atomically(folder_ / "bad.json", text);
    try {
      read_body_poses(folder_ / "bad.json");
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("bad.json"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(read_body_poses(folder_ / "missing.json"), Error);
}

TEST_F(BodyPoses, ACheckpointKeepsTheirStates) {
  Checkpoint checkpoint;
  checkpoint.frame = 3;
  BodyState<3> state{Vec3(0.1, 0.2, 0.3), rotation_of<3>(to_skew(Vec3(1, 2, 3))), Vec3(4, 5, 6),
                     to_skew(Vec3(7, 8, 1.0 / 9.0))};
  checkpoint.bodies = {state, BodyState<3>{}};
  write_checkpoint(folder_ / "checkpoint.bin", checkpoint);
  const Checkpoint read = read_checkpoint(folder_ / "checkpoint.bin");
  ASSERT_EQ(read.bodies.size(), 2u);
  EXPECT_EQ(read.bodies[0].centre, state.centre);
  EXPECT_EQ(read.bodies[0].rotation, state.rotation);
  EXPECT_EQ(read.bodies[0].velocity, state.velocity);
  EXPECT_EQ(read.bodies[0].angular_momentum, state.angular_momentum);
}

}  // namespace
}  // namespace smelt
