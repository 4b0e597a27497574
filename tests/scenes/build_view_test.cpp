#include "scenes/build_view.h"

#include "core/error.h"
#include "scenes/scene_reader.h"
#include "tests/source_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <unistd.h>

namespace smelt {
namespace {

Scene read_with(const std::string& more, const std::vector<std::string>& overrides = {}) {
  const auto path = std::filesystem::path(testing::TempDir()) / ("build_view_" + std::to_string(::getpid()) + ".toml");
  std::ofstream(path) << R"(
[shot]
name = "test"
frames = 10
fps = 24
[particles]
count = 100
rest_position = true
[[material]]
name = "rock"
density_kg_m3 = 2600
viscosity = { law = "newtonian", viscosity_Pa_s = 100.0 }
heat = { diffusivity_m2_s = 1e-3, cold_K = 1000.0, hot_K = 1400.0 }
[[body]]
mesh = "assets/bunny.obj"
material = "rock"
temperature_K = 1300
[[collider]]
mesh = "assets/sphere.obj"
velocity_m_s = [2.0, 0.0, 0.0]
material = "metal"
roughness = 0.2
)" << more;
  return read_scene(path, overrides);
}

std::string error_of(const std::string& more) {
  try {
    read_with(more);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(BuildView, LavaGlowsAndKeepsItsRange) {
  const RenderScene view = build_view(read_with("[look]\nmaterial = \"lava\"\ncrust = { plate_m = 2.0 }\n"));
  ASSERT_TRUE(view.look.black_body.has_value());
  ASSERT_TRUE(view.look.crust.has_value());
  EXPECT_FLOAT_EQ(view.look.crust->plate_m, 2.0f);
  EXPECT_FLOAT_EQ(view.look.cold_K, 1000.0f);
  EXPECT_EQ(view.look.material, MaterialKind::rock);
  EXPECT_EQ(view.colliders[0].material, MaterialKind::metal);
}

TEST(BuildView, AFiftyMillimetreLens) {
  const Camera camera =
      build_view(read_with("[camera]\nfocal_length_m = 0.05\nf_number = 2.0\nshutter = 0.5\n")).camera;
  EXPECT_NEAR(camera.vertical_fov_deg, 2.0 * std::atan(0.012 / 0.05) * 180.0 / std::numbers::pi, 1e-9);
  EXPECT_NEAR(camera.aperture, 0.025, 1e-9);
  EXPECT_NEAR(camera.shutter, 0.5 / 24.0, 1e-12);
}

TEST(BuildView, CameraFollowsItsKeyframes) {
  const Scene scene = read_with(
      "[camera]\neye_m = [0.0, 1.0, 5.0]\ntarget_m = [0.0, 0.0, 0.0]\ninterpolation = \"linear\"\n"
      "keyframes = [{ time_s = 1.0 }, { time_s = 2.0, eye_m = [4.0, 1.0, 5.0] }]\n");
  const Camera camera = build_view(scene).camera;
  EXPECT_EQ(camera_at(scene, camera, 0.0).eye, Vec3(0.0, 1.0, 5.0));
  EXPECT_LT((camera_at(scene, camera, 1.25).eye - Vec3(1.0, 1.0, 5.0)).norm(), 1e-12);
  EXPECT_EQ(camera_at(scene, camera, 9.0).eye, Vec3(4.0, 1.0, 5.0));
}

TEST(BuildView, MovingCollidersKnowTheirSpeed) {
  const Scene scene = read_with("[camera]\nshutter = 0.5\n");
  RenderScene view = build_view(scene);
  const auto at_rest = view.colliders;
  place_colliders(scene, 0.1, {}, at_rest, view);
  ASSERT_EQ(view.colliders[0].velocity.size(), view.colliders[0].mesh.vertices.size());
  EXPECT_LT((view.colliders[0].velocity[0] - Vec3f(2.0f, 0.0f, 0.0f)).norm(), 1e-4f);
}

TEST(BuildView, SkyTakesThePlaceOfTheLamps) {
  const RenderScene view = build_view(read_with("[environment]\nkind = \"sky\"\n"));
  EXPECT_TRUE(view.lights.empty());
  EXPECT_TRUE(view.sun.has_value());
  EXPECT_TRUE(view.show_environment);
}

TEST(BuildView, BadPicturesAreRefusedWithKeyAndFile) {
  const auto expect = [](const std::string& more, const std::string& key) {
    const std::string error = error_of(more);
    EXPECT_NE(error.find(key), std::string::npos) << error;
    EXPECT_NE(error.find("build_view_"), std::string::npos) << error;
  };
  expect("[look]\nmaterial = \"gold\"\n", "look.material");
  expect("[camera]\nwidth = 16000\nheight = 16000\n", "camera.width");
  expect("[camera]\neye_m = [1.0, 1.0, 1.0]\ntarget_m = [1.0, 1.0, 1.0]\n", "camera.target_m");
  expect("[[light]]\nposition_m = [0.0, 2.0, 0.0]\nwidth_m = 0.0\n", "light.0.width_m");
  expect("[[light]]\nposition_m = [0.0, 2.0, 0.0]\ntarget_m = [0.0, 2.0, 0.0]\n", "light.0.target_m");
  expect("[environment]\nkind = \"image\"\nimage = \"nowhere.exr\"\n", "environment.image");
  expect("[environment]\nkind = \"image\"\n", "environment.image");
  expect("[camera]\nkeyframes = [{ time_s = 1.0 }, { time_s = 1.0 }]\n", "camera.keyframes.1.time_s");
  expect("[render]\npng_bits = 12\n", "render.png_bits");
}

}  // namespace
}  // namespace smelt
