#include "core/error.h"
#include "io/obj.h"
#include "io/particles_vdb.h"
#include "scenes/stages.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <string>
#include <unistd.h>
#include <vector>

namespace smelt {
namespace {

namespace fs = std::filesystem;

struct Listener : Progress {
  std::vector<std::string> messages;
  void message(const std::string& text) override { messages.push_back(text); }
};

/// n^3 particles, as of frame `frame`.
ParticleFrame cube(int n, int frame) {
  ParticleFrame p;
  p.spacing = 0.1;
  p.mass = 1.0;
  p.smoothing_length = 0.12;
  p.frame = frame;
  for (int i = 0; i < n * n * n; ++i) {
    p.position.push_back(p.spacing * Vec3(i % n, i / n % n, i / (n * n)));
    p.velocity.push_back(Vec3f::Zero());
    p.density.push_back(1000.0f);
    p.id.push_back(i);
  }
  return p;
}

class SurfaceFrames : public ::testing::Test {
 protected:
  SurfaceFrames() {
    fs::remove_all(folder_.root);
    fs::create_directories(folder_.particles());
    scene_.file = "scene.toml";
    scene_.surface.anisotropic = false;
    scene_.surface.thin_feature_gain = 0.0;
  }
  ~SurfaceFrames() override { fs::remove_all(folder_.root); }

  std::size_t n_triangles(int frame) const { return read_obj(folder_.surface_obj(frame)).mesh.triangles.size(); }

  Scene scene_;
  OutputFolder folder_{fs::path(::testing::TempDir()) / ("surface_frames_" + std::to_string(::getpid()))};
  Listener listener_;
};

// As of a vent that lets go of one drop first, with the bare chi: its frame has an empty surface, and the user is told.
TEST_F(SurfaceFrames, ParticlesWithoutASurfaceDoNotEndTheStage) {
  for (int frame = 1; frame <= 7; ++frame) write_particles(folder_.particles(frame), cube(frame < 6 ? 1 : 5, frame));
  RunReport report(folder_.report(), false);
  surface_frames(scene_, folder_, {{1, 7}, false}, report, listener_);
  EXPECT_EQ(n_triangles(1), 0u);
  EXPECT_EQ(n_triangles(5), 0u);
  EXPECT_GT(n_triangles(6), 100u);
  EXPECT_GT(n_triangles(7), 100u);
  ASSERT_EQ(listener_.messages.size(), 4u) << "three frames, and how many there were";
  EXPECT_NE(listener_.messages[0].find("warning: frame 1: its 1 particles have no surface"), std::string::npos);
  EXPECT_NE(listener_.messages[0].find("thin_feature_gain"), std::string::npos);
  EXPECT_NE(listener_.messages[3].find("5 frames"), std::string::npos);
  EXPECT_TRUE(report.settings_of(1, "surface")) << "done: --resume leaves it";
}

TEST_F(SurfaceFrames, AFrameThatCannotBeReadDoesNotKeepTheOthersFromBeingSurfaced) {
  for (const int frame : {1, 3}) write_particles(folder_.particles(frame), cube(5, frame));
  ParticleFrame broken = cube(5, 4);
  broken.velocity[17][1] = std::numeric_limits<float>::infinity();
  write_particles(folder_.particles(4), broken);
  RunReport report(folder_.report(), false);
  try {
    surface_frames(scene_, folder_, {{1, 4}, false}, report, listener_);
    ADD_FAILURE() << "nothing was said at the end";
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("scene.toml: frame 2: "), std::string::npos) << what;
    EXPECT_NE(what.find("1 more frames of stage \"surface\""), std::string::npos) << what;
  }
  EXPECT_GT(n_triangles(1), 100u);
  EXPECT_GT(n_triangles(3), 100u);
  EXPECT_FALSE(fs::exists(folder_.surface_obj(4)));
  ASSERT_EQ(listener_.messages.size(), 2u);
  EXPECT_NE(listener_.messages[1].find("particle 17 has the velocity (0, inf, 0) m/s"), std::string::npos)
      << listener_.messages[1];
  EXPECT_FALSE(report.settings_of(4, "surface"));
}

}  // namespace
}  // namespace smelt
