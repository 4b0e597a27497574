#include "render/render_frame.h"

#include "core/error.h"
#include "render/sample_film.h"
#include "render/tone_map.h"
#include "tests/render/test_meshes.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <functional>
#include <limits>

namespace smelt {
namespace {

using test::make_quad;
using test::make_sphere;
using test::white_room;

Film trace(const SurfaceMesh& fluid, const RenderScene& scene, int samples) {
  check_scene(scene);
  RenderOptions options;
  options.samples = samples;
  return sample_film(ShadingScene(fluid, scene), options, 1);
}

Vec3f radiance(const Film& film, std::size_t i) {
  return read_pixel(film.albedo, i).cwiseProduct(read_pixel(film.light, i)) + read_pixel(film.specular, i) +
         read_pixel(film.emission, i);
}

/// A white sphere in a white room vanishes.
TEST(Furnace, DiffuseSphere) {
  RenderScene scene = white_room(64, 64);
  scene.look.specular = 0.0f;
  const Film film = trace(make_sphere(1.0, Vec3::Zero(), 128), scene, 4);
  for (std::size_t i = 0; i < film.size(); ++i) ASSERT_NEAR(radiance(film, i).x(), 1.0f, 0.005f) << i;
}

TEST(Furnace, CoatedSphereAtEveryRoughness) {
  for (const float roughness : {0.15f, 0.5f, 0.8f}) {
    RenderScene scene = white_room(64, 64);
    scene.look.cold.roughness = roughness;
    const Film film = trace(make_sphere(1.0, Vec3::Zero(), 128), scene, 64);
    double mean = 0.0;
    int n = 0;
    for (std::size_t i = 0; i < film.size(); ++i) {
      if (film.kind[i] < 1.0f) continue;
      mean += radiance(film, i).x();
      ++n;
    }
    ASSERT_GT(n, 500);
    EXPECT_NEAR(mean / n, 1.0, 0.005) << roughness;
  }
}

TEST(Furnace, ScatteringLosesOnlyWhatThinPartsAbsorb) {
  RenderScene scene = white_room(48, 48);
  scene.look.specular = 0.0f;
  scene.look.cold.scatter_m = 0.05f;
  const Film film = trace(make_sphere(1.0, Vec3::Zero(), 128), scene, 64);
  Vec3 mean = Vec3::Zero();
  int n = 0;
  for (std::size_t i = 0; i < film.size(); ++i) {
    if (film.kind[i] < 1.0f) continue;
    mean += radiance(film, i).cast<double>();
    ++n;
  }
  mean /= n;
  EXPECT_NEAR(mean.x(), 1.0, 0.005);
  EXPECT_LT(mean.maxCoeff(), 1.005);
  EXPECT_GT(mean.minCoeff(), 0.95);
}

/// The floor under a lamp, against the irradiance from a lamp so small that it is a point.
TEST(Floor, IrradianceOfASmallLamp) {
  RenderScene scene = white_room(9, 9);
  scene.sky = {Vec3f::Zero(), Vec3f::Zero(), Vec3f::Zero()};
  scene.camera.eye = Vec3(0.0, 2.0, 2.0);
  scene.camera.vertical_fov_deg = 0.5;
  scene.ground.enabled = true;
  scene.ground.colour = Vec3f::Constant(0.5f);
  scene.ground.fade_start = 1e3;
  scene.ground.fade_end = 1e4;
  AreaLight lamp;
  lamp.position = Vec3(0.0, 3.0, 0.0);
  lamp.target = Vec3::Zero();
  lamp.width = lamp.height = 0.02;
  lamp.radiance = Vec3f::Constant(1000.0f);
  scene.lights = {lamp};
  const Film film = trace({}, scene, 16);
  const double expected = 0.5 / std::numbers::pi * 1000.0 * 0.02 * 0.02 / 9.0;
  EXPECT_NEAR(radiance(film, film.index(4, 4)).x(), expected, 2e-3 * expected);
}

/// A half plane at height h under a lamp of width w at height H throws a penumbra h w / (H - h) wide.
TEST(Floor, PenumbraHasItsWidth) {
  RenderScene scene = white_room(400, 3);
  scene.sky = {Vec3f::Zero(), Vec3f::Zero(), Vec3f::Zero()};
  scene.camera.eye = Vec3(0.0, 0.9, 0.02);                                                   // under the blind
  scene.camera.vertical_fov_deg = 2.0 * std::atan(0.0075 / 0.9) * 180.0 / std::numbers::pi;  // 1 pixel: 5 mm of floor
  scene.ground = {true, 0.0, Vec3f::Ones(), Vec3::Zero(), 1e3, 1e4};
  AreaLight lamp;
  lamp.position = Vec3(0.0, 3.0, 0.0);
  lamp.target = Vec3::Zero();
  lamp.width = lamp.height = 1.0;
  scene.lights = {lamp};
  scene.colliders.resize(1);
  scene.colliders[0].mesh = make_quad(Vec3(0.0, 1.0, -50.0), Vec3(50.0, 0.0, 0.0), Vec3(0.0, 0.0, 100.0));
  const Film film = trace({}, scene, 64);
  const auto share_at = [&](int x) {
    const double from_middle = (x + 0.5 - 200.0) * 0.005;  // the unblocked lamp falls off as cos^4
    return film.light[0][film.index(x, 1)] * std::pow(9.0 + from_middle * from_middle, 2.0);
  };
  const double lit = share_at(20);
  int n_between = 0;
  for (int x = 0; x < 400; ++x) n_between += share_at(x) > 0.05 * lit && share_at(x) < 0.95 * lit ? 1 : 0;
  EXPECT_NEAR(n_between * 0.005, 0.9 * 0.5, 0.03);  // lamp of 1 m, blind 1 m up of 3: half a metre from 0 to 1
}

RenderScene small_default_scene(const SurfaceMesh& fluid) {
  Box3 bounds;
  for (const Vec3& vertex : fluid.mesh.vertices) bounds.extend(vertex);
  RenderScene scene = default_scene(bounds);
  scene.camera.width = 120;
  scene.camera.height = 70;
  return scene;
}

TEST(RenderFrame, SameBytesOnAnyThreadCount) {
  SurfaceMesh ball = make_sphere(0.5, Vec3(0.0, 0.5, 0.0), 40);
  for (const Vec3& v : ball.mesh.vertices) ball.temperature.push_back(static_cast<float>(300.0 + 100.0 * v.y()));
  const RenderScene scene = small_default_scene(ball);
  const auto render = [&](std::size_t n_threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, n_threads);
    return render_frame(ball, scene, {}, 1).pixels;
  };
  const auto one = render(1);
  EXPECT_EQ(one, render(2));
  EXPECT_EQ(one, render(2));
}

TEST(RenderFrame, NoiseMovesOnlyWhenAsked) {
  const SurfaceMesh ball = make_sphere(0.5, Vec3(0.0, 0.5, 0.0), 16);
  const RenderScene scene = small_default_scene(ball);
  RenderOptions options;
  EXPECT_EQ(render_frame(ball, scene, options, 1).pixels, render_frame(ball, scene, options, 2).pixels);
  options.moving_noise = true;
  EXPECT_NE(render_frame(ball, scene, options, 1).pixels, render_frame(ball, scene, options, 2).pixels);
}

TEST(RenderFrame, HotShowsWarmerThanCold) {
  SurfaceMesh ball = make_sphere(0.5, Vec3(0.0, 0.5, 0.0), 24);
  const RenderScene scene = small_default_scene(ball);
  const auto mean_colour = [&](float kelvin) {
    ball.temperature.assign(ball.mesh.vertices.size(), kelvin);
    const ImageRgb8 image = render_frame(ball, scene, {}, 1);
    return image.pixels[static_cast<std::size_t>(image.width * (image.height / 2) + image.width / 2)];
  };
  const auto cold = mean_colour(300.0f), hot = mean_colour(400.0f);
  EXPECT_GT(hot[0] - hot[2], cold[0] - cold[2] + 30);
}

TEST(RenderFrame, EmptyFluidShowsTheFloorAlone) {
  RenderScene scene = default_scene(Box3{});
  scene.camera.width = 64;
  scene.camera.height = 36;
  const ImageRgb8 image = render_frame({}, scene, {}, 1);
  ASSERT_EQ(image.pixels.size(), 64U * 36U);
  EXPECT_GT(image.pixels.back()[1], 30);
}

TEST(RenderFrame, DegenerateTrianglesAndNormalsDoNoHarm) {
  SurfaceMesh ball = make_sphere(0.5, Vec3(0.0, 0.5, 0.0), 16);
  ball.mesh.triangles.push_back({0, 0, 0});
  ball.normals[40] = Vec3f::Zero();
  ball.normals[41] = Vec3f::Constant(std::numeric_limits<float>::quiet_NaN());
  const RenderScene scene = small_default_scene(ball);
  const Film film = trace(ball, scene, 4);
  for (std::size_t i = 0; i < film.size(); ++i) {
    ASSERT_TRUE(radiance(film, i).allFinite()) << i;
    ASSERT_GE(radiance(film, i).minCoeff(), 0.0f) << i;
  }
}

struct Refusal {
  const char* name;
  const char* message;  ///< must occur in the error
  std::function<void(RenderScene&, SurfaceMesh&, RenderOptions&)> spoil;
};

class RefusalTest : public testing::TestWithParam<Refusal> {};

TEST_P(RefusalTest, NamesTheCulprit) {
  SurfaceMesh ball = make_sphere(0.5, Vec3(0.0, 0.5, 0.0), 16);
  RenderScene scene = small_default_scene(ball);
  RenderOptions options;
  EXPECT_NO_THROW(render_frame(ball, scene, options, 1));
  GetParam().spoil(scene, ball, options);
  try {
    render_frame(ball, scene, options, 1);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().message), std::string::npos) << error.what();
  }
}

const float nan_f = std::numeric_limits<float>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    RenderFrame, RefusalTest,
    testing::Values(
        Refusal{"EyeInside", "inside the fluid", [](auto& s, auto&, auto&) { s.camera.eye = Vec3(0.1, 0.5, 0.0); }},
        Refusal{"EyeBelowFloor", "below the floor", [](auto& s, auto&, auto&) { s.camera.eye.y() = -1.0; }},
        Refusal{"EyeIsTarget", "camera.target_m", [](auto& s, auto&, auto&) { s.camera.target = s.camera.eye; }},
        Refusal{"UpAlongView", "camera.up",
                [](auto& s, auto&, auto&) { s.camera.up = s.camera.target - s.camera.eye; }},
        Refusal{"FieldOfView", "vertical_fov_deg", [](auto& s, auto&, auto&) { s.camera.vertical_fov_deg = 180.0; }},
        Refusal{"ZeroWidth", "at least 1", [](auto& s, auto&, auto&) { s.camera.width = 0; }},
        Refusal{"TooManyPixels", "memory", [](auto& s, auto&, auto&) { s.camera.width = s.camera.height = 60000; }},
        Refusal{"FlatLight", "light.1", [](auto& s, auto&, auto&) { s.lights[1].height = 0.0; }},
        Refusal{"NanLight", "light.0.radiance", [](auto& s, auto&, auto&) { s.lights[0].radiance.x() = nan_f; }},
        Refusal{"NegativeSky", "sky.horizon", [](auto& s, auto&, auto&) { s.sky.horizon.y() = -0.1f; }},
        Refusal{"Albedo", "look.hot.colour", [](auto& s, auto&, auto&) { s.look.hot.base_colour.z() = 1.5f; }},
        Refusal{"Temperatures", "cold_K", [](auto& s, auto&, auto&) { s.look.cold_K = s.look.hot_K; }},
        Refusal{"Fade", "fade_start", [](auto& s, auto&, auto&) { s.ground.fade_end = s.ground.fade_start; }},
        Refusal{"Exposure", "exposure", [](auto& s, auto&, auto&) { s.exposure = 0.0; }},
        Refusal{"Samples", "samples", [](auto&, auto&, auto& o) { o.samples = 0; }},
        Refusal{"ColliderIndex", "collider.0",
                [](auto& s, auto&, auto&) {
                  s.colliders.emplace_back().mesh.triangles = {{0, 1, 2}};
                }},
        Refusal{"FewTemperatures", "temperatures", [](auto&, auto& m, auto&) { m.temperature.resize(3); }},
        Refusal{"NanVertex", "vertex 5", [](auto&, auto& m, auto&) { m.mesh.vertices[5].x() = std::nan(""); }},
        Refusal{"TriangleIndex", "triangle 7", [](auto&, auto& m, auto&) { m.mesh.triangles[7][1] = 1u << 30; }}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace smelt
