// Light along whole paths, against what theory says of simple rooms.

#include "render/black_body.h"
#include "render/render_frame.h"
#include "render/sample_film.h"
#include "tests/render/test_meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

namespace smelt {
namespace {

using test::make_quad;
using test::make_sphere;
using test::white_room;

Film trace(const SurfaceMesh& fluid, const RenderScene& scene, RenderOptions options) {
  check_scene(scene);
  return sample_film(ShadingScene(fluid, scene), options, 1);
}

RenderOptions samples(int n, int bounces = 1, float firefly_limit = 0.0f) {
  RenderOptions options;
  options.samples = n;
  options.bounces = bounces;
  options.firefly_limit = firefly_limit;
  return options;
}

/// Mean over the pixels that show nothing but fluid.
Vec3 mean_of_fluid(const Film& film) {
  Vec3 mean = Vec3::Zero();
  int n = 0;
  for (std::size_t i = 0; i < film.size(); ++i) {
    if (film.kind[i] != 1.0f) continue;
    mean += radiance_at(film, i).cast<double>();
    ++n;
  }
  EXPECT_GT(n, 300);
  return mean / n;
}

TEST(Furnace, MetalSphereAtEveryRoughness) {
  for (const float roughness : {0.15f, 0.5f, 0.9f}) {
    RenderScene scene = white_room(64, 64);
    scene.look.material = MaterialKind::metal;
    scene.look.cold = {Vec3f::Ones(), roughness, 0.0f};
    EXPECT_NEAR(mean_of_fluid(trace(make_sphere(1.0, Vec3::Zero(), 128), scene, samples(64))).x(), 1.0, 0.005)
        << roughness;
  }
}

TEST(Furnace, OneLobeASampleIsAsWhiteAsTwo) {
  RenderScene scene = white_room(64, 64);
  scene.look.cold.roughness = 0.4f;
  const SurfaceMesh ball = make_sphere(1.0, Vec3::Zero(), 128);
  EXPECT_NEAR(mean_of_fluid(trace(ball, scene, samples(8))).x(), 1.0, 0.005);    // body and coat each
  EXPECT_NEAR(mean_of_fluid(trace(ball, scene, samples(256))).x(), 1.0, 0.005);  // one of them
}

/// By a panorama instead of the gradient sky: drawn as a light, and still all white.
TEST(Furnace, PanoramaOfRadianceOne) {
  auto image = std::make_shared<RadianceImage>();
  image->width = 16;
  image->height = 8;
  image->pixels.assign(16 * 8, Vec3f::Ones());
  RenderScene scene = white_room(64, 64);
  scene.environment = Environment{image, 0.0, 1.0f};
  scene.show_environment = true;
  const Film film = trace(make_sphere(1.0, Vec3::Zero(), 128), scene, samples(64));
  EXPECT_NEAR(mean_of_fluid(film).x(), 1.0, 0.005);
  EXPECT_NEAR(radiance_at(film, 0).x(), 1.0f, 1e-5f);
}

/// Two bounces between white walls: what a fold loses with one bounce comes back.
TEST(Furnace, WhiteFoldsFillWithBounces) {
  RenderScene scene = white_room(32, 32);
  scene.look.specular = 0.0f;
  SurfaceMesh fold;  // a right angle, open to the camera
  fold.mesh = {{Vec3(0, -1, -1), Vec3(0, 1, -1), Vec3(1, 1, 0), Vec3(1, -1, 0), Vec3(-1, -1, 0), Vec3(-1, 1, 0)},
               {{0, 2, 1}, {0, 3, 2}, {0, 1, 5}, {0, 5, 4}}};
  scene.camera.vertical_fov_deg = 6.0;
  const double one = mean_of_fluid(trace(fold, scene, samples(64, 1))).x();
  const double many = mean_of_fluid(trace(fold, scene, samples(64, 16))).x();
  EXPECT_LT(one, 0.97);
  EXPECT_NEAR(many, 1.0, 0.005);
}

/// A glowing sphere shows Planck's radiance for its temperature, whatever else is there.
TEST(Glow, SphereShowsItsBlackBody) {
  RenderScene scene = white_room(32, 32);
  scene.sky = {Vec3f::Zero(), Vec3f::Zero(), Vec3f::Zero()};
  scene.look.black_body = BlackBodyLook{0.8f, 100.0f};
  scene.look.cold.base_colour = scene.look.hot.base_colour = Vec3f::Zero();
  scene.look.specular = 0.0f;
  SurfaceMesh ball = make_sphere(1.0, Vec3::Zero(), 64);
  ball.temperature.assign(ball.mesh.vertices.size(), 1300.0f);
  const Vec3 expected = (BlackBodyTable()(1300.0f) * (0.8f / 100.0f)).cast<double>();
  EXPECT_LT((mean_of_fluid(trace(ball, scene, samples(4))) - expected).cwiseAbs().maxCoeff(),
            1e-4 * expected.maxCoeff());
}

/// Irradiance of a floor under a uniformly glowing sphere of radiance L: pi L (R/d)^2 at its foot, by drawn lights and
/// rays together, over what it is. Small in a large scene, it is as near as a few hundred times what rays start off
/// their surface.
double light_under_a_sphere(double size, float fall = 0.0f) {
  RenderScene scene = white_room(9, 9);
  scene.sky = {Vec3f::Zero(), Vec3f::Zero(), Vec3f::Zero()};
  scene.camera.eye = Vec3(0.0, 0.5, 4.0);
  scene.camera.target = Vec3::Zero();
  scene.camera.vertical_fov_deg = 0.3;
  scene.ground = {true, 0.0, Vec3f::Constant(0.5f), Vec3::Zero(), 1e3, 1e4};
  scene.look.specular = 0.0f;
  scene.look.cold.base_colour = Vec3f::Zero();
  scene.look.black_body = BlackBodyLook{1.0f, 100.0f};
  SurfaceMesh ball = make_sphere(0.5 * size, Vec3(0.0, 1.5 * size, 0.0), 64);
  ball.temperature.assign(ball.mesh.vertices.size(), 1300.0f);
  const double radiance = (BlackBodyTable()(1300.0f) / 100.0f).x();
  const double expected = 0.5 * radiance * (0.5 / 1.5) * (0.5 / 1.5);
  if (fall > 0.0f) {
    scene.camera.shutter = 0.25;
    ball.velocity.assign(ball.mesh.vertices.size(), Vec3f(0.0f, -fall, 0.0f));
  }
  ColliderView far;
  far.mesh = {{Vec3(100, 0, 0), Vec3(101, 0, 0), Vec3(100, 0, 1)}, {{0, 1, 2}}};
  scene.colliders.push_back(far);
  return radiance_at(trace(ball, scene, samples(1024)), 40).x() / expected;
}
TEST(Glow, SphereLightsTheFloorAsTheoryHasIt) {
  EXPECT_NEAR(light_under_a_sphere(1.0), 1.0, 0.01);
  EXPECT_NEAR(light_under_a_sphere(0.05), 1.0, 0.02);
}

// A drop a third of a pixel wide, wherever it is in the pixel: as bright as the area that it covers.
TEST(Film, ADropSmallerThanAPixelIsNeitherLostNorDimmed) {
  RenderScene scene = white_room(48, 48);
  scene.sky = {Vec3f::Zero(), Vec3f::Zero(), Vec3f::Zero()};
  scene.backdrop = {};
  scene.show_environment = true;
  scene.camera.eye = Vec3(0.0, 0.0, 10.0);
  scene.camera.target = Vec3::Zero();
  scene.camera.vertical_fov_deg = 30.0;
  scene.look.black_body = BlackBodyLook{1.0f, 100.0f};
  scene.look.cold.base_colour = scene.look.hot.base_colour = Vec3f::Zero();
  scene.look.specular = 0.0f;
  const double pixel = 2.0 * 10.0 * std::tan(15.0 * M_PI / 180.0) / 48.0, radius = pixel / 6.0;
  const double expected = (BlackBodyTable()(1300.0f) / 100.0f).x() * M_PI / 36.0;
  for (const double offset : {0.2, 0.35, 0.5, 0.65, 0.8}) {
    SurfaceMesh drop = make_sphere(radius, Vec3(pixel * offset, pixel * (0.9 - 0.7 * offset), 0.0), 16);
    drop.temperature.assign(drop.mesh.vertices.size(), 1300.0f);
    double sum = 0.0;
    const Film film = trace(drop, scene, samples(64));
    for (std::size_t i = 0; i < film.size(); ++i) sum += radiance_at(film, i).x();
    EXPECT_NEAR(sum, expected, 0.35 * expected) << offset;
  }
}

// From d = 1.75 to 1.25 while the shutter is open: the mean of 1/d^2 is 1.0286 times that in the middle.
TEST(Glow, AFallingSphereLightsTheFloorAllTheWay) {
  EXPECT_NEAR(light_under_a_sphere(1.0, 2.0f), 1.0286, 0.01);
}

// White wax on a mirror in a white room: what the mirror shows of the room reaches the wax.
TEST(Furnace, AMetalMetLastShowsTheRoom) {
  RenderScene scene = white_room(64, 64);
  ColliderView mirror;
  mirror.mesh = {{Vec3(-9, -1.5, -9), Vec3(-9, -1.5, 9), Vec3(9, -1.5, 9), Vec3(9, -1.5, -9)}, {{0, 1, 2}, {0, 2, 3}}};
  mirror.material = MaterialKind::metal;
  mirror.colour = Vec3f::Ones();
  mirror.roughness = 0.02f;
  scene.colliders.push_back(mirror);
  const SurfaceMesh ball = make_sphere(1.0, Vec3::Zero(), 64);
  const double one = mean_of_fluid(trace(ball, scene, samples(64, 1))).x();
  const double two = mean_of_fluid(trace(ball, scene, samples(64, 2))).x();
  EXPECT_GT(one, 0.85);
  EXPECT_NEAR(one, two, 0.12);
}

/// Deviation of the picture from its mean over seeds, at n and 16 n samples: a quarter, or less as the samples are well
/// spread.
TEST(Noise, FallsAtLeastAsOneOverTheRoot) {
  RenderScene scene = white_room(40, 24);
  scene.sky = {Vec3f::Constant(0.2f), Vec3f::Constant(0.2f), Vec3f::Constant(0.2f)};
  AreaLight lamp;
  lamp.position = Vec3(2.0, 3.0, 3.0);
  lamp.radiance = Vec3f::Constant(20.0f);
  scene.lights = {lamp};
  const SurfaceMesh ball = make_sphere(1.0, Vec3::Zero(), 64);
  const auto deviation = [&](int n) {
    std::vector<Film> films;
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
      RenderOptions options = samples(n, 2);
      options.seed = seed;
      films.push_back(trace(ball, scene, options));
    }
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < films[0].size(); ++i) {
      if (films[0].kind[i] != 1.0f) continue;
      double mean = 0.0, square = 0.0;
      for (const Film& film : films) {
        const double l = luminance(radiance_at(film, i));
        mean += l / 6.0;
        square += l * l / 6.0;
      }
      sum += std::max(0.0, square - mean * mean) * 6.0 / 5.0;
      ++count;
    }
    return std::sqrt(sum / count);
  };
  const double coarse = deviation(16), fine = deviation(256);
  EXPECT_GT(coarse, 0.0);
  EXPECT_LT(fine / coarse, 0.25 * 1.1);
}

TEST(Fireflies, LimitDarkensByWhatItSays) {
  RenderScene scene = white_room(48, 48);
  scene.sky = {Vec3f::Zero(), Vec3f::Zero(), Vec3f::Zero()};
  scene.look.specular = 0.0f;
  AreaLight lamp;
  lamp.position = Vec3(0.0, 3.0, 0.0);
  lamp.width = lamp.height = 0.1;
  lamp.radiance = Vec3f::Constant(4e4f);
  scene.lights = {lamp};
  scene.colliders.emplace_back().mesh = make_quad(Vec3(-2.0, -1.2, -2.0), Vec3(0.0, 0.0, 4.0), Vec3(4.0, 0.0, 0.0));
  scene.colliders[0].colour = Vec3f::Ones();
  const SurfaceMesh ball = make_sphere(1.0, Vec3::Zero(), 64);
  const auto total = [](const Film& film) {
    double sum = 0.0;
    for (std::size_t i = 0; i < film.size(); ++i) sum += luminance(radiance_at(film, i));
    return sum;
  };
  const Film whole = trace(ball, scene, samples(32, 2)), limited = trace(ball, scene, samples(32, 2, 3.0f));
  EXPECT_EQ(clamped_share(whole), 0.0);
  const double share = clamped_share(limited);
  EXPECT_GT(share, 0.001);
  EXPECT_NEAR(total(limited) / total(whole), 1.0 - share, 2e-3);
}

/// Out of focus, a bright edge spreads over the circle of confusion: aperture |d - f| / f in the plane of the edge.
TEST(Lens, CircleOfConfusionHasItsSize) {
  RenderScene scene = white_room(400, 3);
  scene.backdrop.low = scene.backdrop.high = Vec3f::Zero();
  scene.camera.eye = Vec3(0.0, 0.0, 4.0);
  scene.camera.target = Vec3(0.0, 0.0, 0.0);
  scene.camera.vertical_fov_deg =
      2.0 * std::atan(0.0075 / 4.0) * 180.0 / std::numbers::pi;  // 1 pixel: 5 mm at the edge
  scene.camera.aperture = 0.8;
  scene.camera.focus_distance = 2.0;
  scene.look.specular = 0.0f;
  SurfaceMesh half_plane;
  half_plane.mesh = make_quad(Vec3(0.0, -5.0, 0.0), Vec3(50.0, 0.0, 0.0), Vec3(0.0, 10.0, 0.0));
  const Film film = trace(half_plane, scene, samples(256));
  int n_between = 0;
  for (int x = 0; x < 400; ++x) {
    const float share = film.kind[film.index(x, 1)];
    n_between += share > 0.02f && share < 0.98f ? 1 : 0;
  }
  // 0.8 m wide, of which the chord beyond 2 % of a disk's area is 91 %.
  EXPECT_NEAR(n_between * 0.005, 0.8 * 0.905, 0.03);
}

/// What moves while the shutter is open covers a strip as long as its way.
TEST(MotionBlur, StripIsAsLongAsTheWay) {
  RenderScene scene = white_room(400, 3);
  scene.backdrop.low = scene.backdrop.high = Vec3f::Zero();
  scene.camera.eye = Vec3(0.0, 0.0, 4.0);
  scene.camera.vertical_fov_deg = 2.0 * std::atan(0.0075 / 4.0) * 180.0 / std::numbers::pi;
  scene.camera.shutter = 0.02;
  scene.look.specular = 0.0f;
  SurfaceMesh half_plane;
  half_plane.mesh = make_quad(Vec3(0.0, -5.0, 0.0), Vec3(50.0, 0.0, 0.0), Vec3(0.0, 10.0, 0.0));
  half_plane.velocity.assign(4, Vec3f(30.0f, 0.0f, 0.0f));
  const Film film = trace(half_plane, scene, samples(256));
  double covered = 0.0;
  int n_between = 0;
  for (int x = 0; x < 400; ++x) {
    const float share = film.kind[film.index(x, 1)];
    covered += share;
    n_between += share > 0.02f && share < 0.98f ? 1 : 0;
  }
  EXPECT_NEAR(n_between * 0.005, 30.0 * 0.02 * 0.96, 0.02);
  EXPECT_NEAR(covered, 200.0, 1.0);  // half-way where the mesh says
}

TEST(Layers, SayWhatIsSeen) {
  RenderScene scene = white_room(32, 32);
  scene.look.hot = scene.look.cold;
  SurfaceMesh ball = make_sphere(1.0, Vec3::Zero(), 64);
  ball.temperature.assign(ball.mesh.vertices.size(), 350.0f);
  ball.velocity.assign(ball.mesh.vertices.size(), Vec3f(1.0f, 2.0f, 3.0f));
  RenderOptions options = samples(16);
  options.layers = true;
  const LayeredImage image = to_layers(trace(ball, scene, options), scene.camera.eye);
  const auto at = [&](const std::string& name, std::size_t i) {
    for (const ImageChannel& channel : image.channels)
      if (channel.name == name) return channel.values[i];
    ADD_FAILURE() << "no channel " << name;
    return 0.0f;
  };
  const std::size_t middle = 16 * 32 + 16, corner = 0;
  EXPECT_FLOAT_EQ(at("A", middle), 1.0f);
  EXPECT_FLOAT_EQ(at("A", corner), 0.0f);
  EXPECT_NEAR(at("depth.Z", middle), 4.0f, 0.02f);
  EXPECT_FLOAT_EQ(at("depth.Z", corner), 0.0f);
  EXPECT_NEAR(at("normal.Z", middle), 1.0f, 0.02f);
  EXPECT_NEAR(at("position.Z", middle), 1.0f, 0.02f);
  EXPECT_FLOAT_EQ(at("temperature.T", middle), 350.0f);
  EXPECT_FLOAT_EQ(at("velocity.Y", middle), 2.0f);
  EXPECT_FLOAT_EQ(at("albedo.G", middle), 1.0f);
}

}  // namespace
}  // namespace smelt
