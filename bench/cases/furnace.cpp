#include "bench/cases/furnace.h"

#include "bench/cases/cpu_clock.h"
#include "bench/cases/norms.h"
#include "bench/cases/white_room.h"
#include "render/black_body.h"
#include "render/render_frame.h"
#include "render/sample_film.h"

#include <array>
#include <vector>

namespace smelt::furnace {

namespace {

/// Light along whole paths, without a limit to it, filtered or not; `cpu_seconds` becomes what it took.
Film trace(const SurfaceMesh& fluid, const RenderScene& scene, double samples, bool denoise, double& cpu_seconds) {
  RenderOptions options;
  options.samples = static_cast<int>(samples);
  options.firefly_limit = 0.0f;
  options.denoise = denoise;
  const CpuClock clock;
  Film film = denoise ? render_film(fluid, scene, options, 1) : sample_film(ShadingScene(fluid, scene), options, 1);
  cpu_seconds = clock.seconds();
  return film;
}

/// Root mean square of what the red of pixels differs from `expected`, over that; over those alone that show nothing
/// but fluid where `fluid_alone`.
double noise(const Film& film, double expected, bool fluid_alone) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < film.size(); ++i)
    if (!fluid_alone || film.kind[i] == 1.0f) differences.push_back(radiance_at(film, i).x() / expected - 1.0);
  return compute_norms(differences).l2;
}

struct FurnaceMethod {
  MaterialKind material;
  float roughness;
  bool denoise;
};
constexpr std::array furnace_methods{FurnaceMethod{MaterialKind::wax, 0.4f, false},
                                     FurnaceMethod{MaterialKind::wax, 0.4f, true},
                                     FurnaceMethod{MaterialKind::metal, 0.5f, false}};

Measurement run_furnace(std::size_t method, double samples) {
  RenderScene scene = white_room(128, 128);
  scene.look.material = furnace_methods[method].material;
  scene.look.cold.roughness = furnace_methods[method].roughness;
  Measurement measured;
  const Film film =
      trace(make_sphere(1.0, Vec3::Zero(), 128), scene, samples, furnace_methods[method].denoise, measured.cpu_seconds);
  measured.error = noise(film, 1.0, true);
  return measured;
}

Measurement run_black_body(std::size_t, double samples) {
  constexpr float temperature = 1300.0f, unit = 100.0f;  // [K], [cd/m^2] that is shown as 1
  constexpr double radius = 0.5, height = 1.5, albedo = 0.5;
  RenderScene scene = white_room(48, 48);
  scene.sky = {Vec3f::Zero(), Vec3f::Zero(), Vec3f::Zero()};
  scene.camera.eye = Vec3(0.0, 0.5, 4.0);
  scene.camera.target = Vec3::Zero();
  scene.camera.vertical_fov_deg = 0.3;
  scene.ground = {true, 0.0, Vec3f::Constant(static_cast<float>(albedo)), Vec3::Zero(), 1e3, 1e4};
  scene.look.specular = 0.0f;
  scene.look.cold.base_colour = Vec3f::Zero();
  scene.look.black_body = BlackBodyLook{1.0f, unit};
  SurfaceMesh ball = make_sphere(radius, Vec3(0.0, height, 0.0), 64);
  ball.temperature.assign(ball.mesh.vertices.size(), temperature);
  Measurement measured;
  const Film film = trace(ball, scene, samples, false, measured.cpu_seconds);
  const double expected = albedo * (BlackBodyTable()(temperature) / unit).x() * (radius / height) * (radius / height);
  measured.error = noise(film, expected, false);
  return measured;
}

}  // namespace

Case make_furnace_case() {
  return {
      .name = "furnace",
      .title = "Furnace: noise against samples",
      .measures =
          "What pixels of a white sphere differ from the white room that it stands in, root mean square: wax with a "
          "coat, the same after the filter, and metal.",
      .good = "Within 2 %, which an eye does not see.",
      .good_errors = {0.02},
      .error_label = "radiance: L2 error / exact",
      .resolution_label = "samples a pixel",
      .methods = {"wax", "wax, denoised", "metal"},
      .quick = {1, 4, 16, 64},
      .full = {1, 4, 16, 64, 256, 1024},
      .run = run_furnace};
}

Case make_black_body_case() {
  return {.name = "black_body",
          .title = "Black body: noise of its light against samples",
          .measures =
              "The light of a sphere at 1300 K on the floor below it, drawn as light sources and met by rays, against "
              "Planck's law and the solid angle: root mean square over pixels.",
          .good = "Within 2 %, which an eye does not see.",
          .good_errors = {0.02},
          .error_label = "radiance: L2 error / exact",
          .resolution_label = "samples a pixel",
          .methods = {"red channel"},
          .quick = {16, 64, 256, 1024},
          .full = {16, 64, 256, 1024, 4096},
          .run = run_black_body};
}

}  // namespace smelt::furnace
