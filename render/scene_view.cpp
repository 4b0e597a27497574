#include "render/scene_view.h"

#include "core/error.h"
#include "render/film.h"

#include <Eigen/Geometry>

#include <cmath>
#include <string>

namespace smelt {

namespace {

std::string text(const Vec3& v) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x(), v.y(), v.z());
}

void check_point(const std::string& key, const Vec3& v) {
  if (!v.allFinite()) fail("{}: {} is no point; give three finite numbers in metres", key, text(v));
}

void check_albedo(const std::string& key, const Vec3f& colour) {
  if (!(colour.minCoeff() >= 0.0f && colour.maxCoeff() <= 1.0f)) {
    fail("{}: {}; a surface's colour lies between 0 and 1 in each channel", key, text(colour.cast<double>()));
  }
}

void check_radiance(const std::string& key, const Vec3f& colour) {
  if (!(colour.allFinite() && colour.minCoeff() >= 0.0f)) {
    fail("{}: {}; light is finite and not negative in each channel", key, text(colour.cast<double>()));
  }
}

void check_range(const std::string& key, double value, double lower, double upper) {
  if (!(value >= lower && value <= upper))
    fail("{}: {:.6g}; choose between {:.6g} and {:.6g}", key, value, lower, upper);
}

void check_camera(const Camera& camera, const Ground& ground) {
  check_point("camera.eye_m", camera.eye);
  check_point("camera.target_m", camera.target);
  const Vec3 view = camera.target - camera.eye;
  if (view.norm() < 1e-9)
    fail("camera.target_m: {} is the eye itself; choose another point to look at", text(camera.target));
  if (!camera.up.allFinite() || view.normalized().cross(camera.up.stableNormalized()).norm() < 1e-6) {
    fail("camera.up: {} lies along the view; choose another direction", text(camera.up));
  }
  check_range("camera.vertical_fov_deg", camera.vertical_fov_deg, 0.1, 170.0);
  if (camera.width < 1 || camera.height < 1) {
    fail("camera: {} x {} pixels; width and height are at least 1", camera.width, camera.height);
  }
  const std::int64_t n = static_cast<std::int64_t>(camera.width) * camera.height;
  if (n > max_picture_pixels || camera.width > 65535 || camera.height > 65535) {
    fail("camera: {} x {} pixels would take {:.1f} GB of memory; at most {} pixels in all and 65535 a side are drawn",
         camera.width, camera.height, static_cast<double>(n) * static_cast<double>(film_bytes_per_pixel) * 1e-9,
         max_picture_pixels);
  }
  check_range("camera.aperture", camera.aperture, 0.0, 1e6);
  check_range("camera.focus_distance_m", camera.focus_distance, 0.0, 1e12);
  check_range("camera.shutter", camera.shutter, 0.0, 1e12);
  if (ground.enabled && camera.eye.y() <= ground.height) {
    fail("camera.eye_m: {} is below the floor at y = {:.4g}; raise it, or switch the floor off", text(camera.eye),
         ground.height);
  }
}

void check_light(const std::string& key, const AreaLight& light) {
  check_point(key + ".position_m", light.position);
  check_point(key + ".target_m", light.target);
  if ((light.target - light.position).norm() < 1e-9) {
    fail("{}.target_m: {} is the lamp itself; choose the point it faces", key, text(light.target));
  }
  const bool rectangle = light.shape == LightShape::rectangle;
  if (!(light.width > 0.0 && std::isfinite(light.width)) ||
      (rectangle && !(light.height > 0.0 && std::isfinite(light.height)))) {
    fail("{}: size {:.4g} x {:.4g} m has no area; both sides must be above zero", key, light.width, light.height);
  }
  check_radiance(key + ".radiance", light.radiance);
}

void check_wax(const std::string& key, const Wax& wax) {
  check_albedo(key + ".colour", wax.base_colour);
  check_range(key + ".roughness", wax.roughness, 0.01, 1.0);
  check_range(key + ".scatter_m", wax.scatter_m, 0.0, 1e3);
}

void check_look(const Look& look) {
  check_wax("look.cold", look.cold);
  check_wax("look.hot", look.hot);
  if (!(look.scatter_tint.minCoeff() > 0.0f && look.scatter_tint.maxCoeff() <= 1.0f)) {
    fail("look.scatter_tint: {}; each channel is above 0 and at most 1", text(look.scatter_tint.cast<double>()));
  }
  check_range("look.specular", look.specular, 0.0, 1.0);
  check_range("look.ior", look.ior, 1.01, 4.0);
  if (look.black_body) {
    check_range("look.black_body.emissivity", look.black_body->emissivity, 1e-6, 1.0);
    check_range("look.black_body.white_cd_m2", look.black_body->white_cd_m2, 1e-6, 1e12);
  }
  if (look.crust) {
    check_range("look.crust.plate_m", look.crust->plate_m, 1e-6, 1e9);
    check_range("look.crust.crack", look.crust->crack, 1e-4, 0.5);
    check_range("look.crust.cooler_K", look.crust->cooler_K, 0.0, 1e4);
    check_range("look.crust.relief", look.crust->relief, 0.0, 2.0);
  }
  if (!(look.cold_K < look.hot_K) || !std::isfinite(look.hot_K) || !std::isfinite(look.cold_K)) {
    fail("look: cold_K = {:.4g}, hot_K = {:.4g}; cold_K must be below hot_K", look.cold_K, look.hot_K);
  }
}

void check_far_light(const RenderScene& scene) {
  check_radiance("sky.zenith", scene.sky.zenith);
  check_radiance("sky.horizon", scene.sky.horizon);
  check_radiance("sky.ground", scene.sky.ground);
  if (scene.sun) {
    check_radiance("sun.radiance", scene.sun->radiance);
    check_range("sun.angular_radius_deg", scene.sun->angular_radius_deg, 1e-3, 10.0);
    if (!(scene.sun->direction.norm() > 0.0)) fail("sun.direction: {} points nowhere", text(scene.sun->direction));
  }
  if (!scene.environment) return;
  const RadianceImage* image = scene.environment->image.get();
  if (image == nullptr || image->width < 1 || image->height < 1 ||
      image->pixels.size() != static_cast<std::size_t>(image->width) * static_cast<std::size_t>(image->height))
    fail("environment.image: has no pixels, or not as many as its size says");
  check_range("environment.strength", scene.environment->strength, 0.0, 1e9);
}

void check_ground(const Ground& ground) {
  if (!ground.enabled) return;
  check_albedo("ground.colour", ground.colour);
  check_point("ground.centre", ground.centre);
  if (!std::isfinite(ground.height)) fail("ground.height: {}; give a finite number of metres", ground.height);
  if (!(ground.fade_start >= 0.0 && ground.fade_start < ground.fade_end && std::isfinite(ground.fade_end))) {
    fail("ground: fades from {:.4g} to {:.4g} m; fade_start is at least 0 and below fade_end", ground.fade_start,
         ground.fade_end);
  }
}

void check_collider(const std::string& key, const ColliderView& collider) {
  const std::size_t n = collider.mesh.vertices.size();
  check_albedo(key + ".colour", collider.colour);
  if (!collider.normals.empty() && collider.normals.size() != n) {
    fail("{}: {} normals for {} vertices; give one per vertex or none", key, collider.normals.size(), n);
  }
  if (!collider.velocity.empty() && collider.velocity.size() != n)
    fail("{}: {} velocities for {} vertices; give one per vertex or none", key, collider.velocity.size(), n);
  check_range(key + ".roughness", collider.roughness, 0.01, 1.0);
  check_range(key + ".specular", collider.specular, 0.0, 1.0);
  for (const Vec3& vertex : collider.mesh.vertices) check_point(key + ": vertex", vertex);
  for (const auto& triangle : collider.mesh.triangles) {
    for (const std::uint32_t index : triangle) {
      if (index >= n) fail("{}: a triangle uses vertex {}, but there are {}; the mesh is damaged", key, index, n);
    }
  }
}

}  // namespace

void check_scene(const RenderScene& scene) {
  check_camera(scene.camera, scene.ground);
  for (std::size_t i = 0; i < scene.lights.size(); ++i) check_light(fmt::format("light.{}", i), scene.lights[i]);
  check_far_light(scene);
  check_radiance("backdrop.low", scene.backdrop.low);
  check_radiance("backdrop.high", scene.backdrop.high);
  check_range("backdrop.low_deg", scene.backdrop.low_deg, -90.0, 90.0);
  check_range("backdrop.high_deg", scene.backdrop.high_deg, -90.0, 90.0);
  if (!(scene.backdrop.low_deg < scene.backdrop.high_deg)) {
    fail("backdrop: low_deg = {:.4g}, high_deg = {:.4g}; low_deg must be below high_deg", scene.backdrop.low_deg,
         scene.backdrop.high_deg);
  }
  check_look(scene.look);
  check_ground(scene.ground);
  for (std::size_t i = 0; i < scene.colliders.size(); ++i)
    check_collider(fmt::format("collider.{}", i), scene.colliders[i]);
  if (!(scene.exposure > 0.0 && std::isfinite(scene.exposure)))
    fail("exposure: {}; it is a factor above zero", scene.exposure);
}

RenderScene default_scene(const Box3& bounds) {
  Box3 box = bounds;
  if (box.empty()) {
    box.lower = Vec3(-0.5, 0.0, -0.5);
    box.upper = Vec3(0.5, 1.0, 0.5);
  }
  const double size = std::max(box.extent().maxCoeff(), 1e-6);
  const Vec3 foot(box.centre().x(), box.lower.y(), box.centre().z());
  const auto at = [&](double x, double y, double z) { return Vec3(foot + size * Vec3(x, y, z)); };

  RenderScene scene;
  scene.camera.target = at(0.0, 0.42, 0.0);
  scene.camera.eye = at(1.55, 1.30, 4.55);
  scene.camera.vertical_fov_deg = 18.0;

  AreaLight key;
  key.position = at(-2.3, 2.7, 1.9);
  key.target = at(0.0, 0.4, 0.0);
  key.width = key.height = 1.7 * size;
  key.radiance = Vec3f(11.8f, 11.1f, 10.2f);
  AreaLight rim;
  rim.position = at(1.3, 2.6, -3.3);
  rim.target = at(0.0, 0.55, 0.0);
  rim.width = 0.9 * size;
  rim.height = 1.4 * size;
  rim.radiance = Vec3f(20.0f, 15.8f, 11.5f);
  scene.lights = {key, rim};

  scene.ground.height = box.lower.y();
  scene.ground.centre = foot;
  scene.ground.fade_start = 1.2 * size;
  scene.ground.fade_end = 6.5 * size;
  return scene;
}

}  // namespace smelt
