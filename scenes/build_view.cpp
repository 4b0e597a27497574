#include "scenes/build_view.h"

#include "io/exr.h"
#include "io/height_field.h"
#include "render/daylight.h"
#include "render/smooth_collider.h"
#include "scenes/build_simulation.h"
#include "scenes/collider_motion.h"
#include "scenes/scene_reader.h"
#include "surfacing/smooth_mesh.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace smelt {

namespace {

/// What a material looks like where the scene does not say.
Look material_look(const std::string& material) {
  Look look;
  if (material == "wax" || material == "plastic") return look;
  look.material = material == "metal" ? MaterialKind::metal : MaterialKind::rock;
  if (material == "metal") {
    look.cold = look.hot = {{0.56f, 0.57f, 0.58f}, 0.25f, 0.0f};
    return look;
  }
  look.specular = 0.5f;
  look.cold = {{0.045f, 0.042f, 0.040f}, 0.7f, 0.0f};
  look.hot = {{0.06f, 0.05f, 0.045f}, 0.4f, 0.0f};
  if (material == "lava") look.black_body = BlackBodyLook{};
  return look;
}

void set_state(const LookSettings::State& state, Wax& wax) {
  if (state.colour) wax.base_colour = state.colour->cast<float>();
  if (state.roughness) wax.roughness = static_cast<float>(*state.roughness);
  if (state.scatter) wax.scatter_m = static_cast<float>(*state.scatter);
}

Look build_look(const Scene& scene) {
  Look look = material_look(scene.look.material);
  set_state(scene.look.cold, look.cold);
  set_state(scene.look.hot, look.hot);
  if (scene.look.specular) look.specular = static_cast<float>(*scene.look.specular);
  look.ior = static_cast<float>(scene.look.ior);
  if (scene.look.black_body) look.black_body = scene.look.black_body;
  look.crust = scene.look.crust;
  const auto& heat = scene.materials.front().heat;
  if (heat) {
    look.cold_K = static_cast<float>(heat->cold);
    look.hot_K = static_cast<float>(heat->hot);
  }
  if (scene.look.cold_K) look.cold_K = static_cast<float>(*scene.look.cold_K);
  if (scene.look.hot_K) look.hot_K = static_cast<float>(*scene.look.hot_K);
  // A sharp melting point: the look changes within a kelvin, as it must change somewhere.
  if (look.hot_K == look.cold_K) look.hot_K += 1.0f;
  return look;
}

constexpr double degree = std::numbers::pi / 180.0;

void set_camera(const Scene& scene, Camera& camera) {
  const CameraSettings& s = scene.camera;
  camera.eye = s.eye.value_or(camera.eye);
  camera.target = s.target.value_or(camera.target);
  camera.vertical_fov_deg = s.vertical_fov_deg.value_or(camera.vertical_fov_deg);
  if (s.focal_length) camera.vertical_fov_deg = 2.0 * std::atan(0.5 * s.film_height / *s.focal_length) / degree;
  camera.width = s.width;
  camera.height = s.height;
  if (s.f_number)
    camera.aperture = 0.5 * s.film_height / std::tan(0.5 * camera.vertical_fov_deg * degree) / *s.f_number;
  camera.focus_distance = s.focus_distance.value_or(0.0);
  camera.shutter = s.shutter / scene.shot.fps;
}

AreaLight to_light(const LightSettings& s) {
  return {s.shape == "disk" ? LightShape::disk : LightShape::rectangle,
          s.position,
          s.target,
          s.width,
          s.height,
          s.radiance.cast<float>()};
}

/// A terrain's surface is drawn smooth, its walls and bottom are not smoothed into it: their corners are made vertices
/// of their own.
ColliderView terrain_view(TriangleMesh mesh) {
  std::map<std::uint32_t, std::uint32_t> copies;
  for (auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[1]] - mesh.vertices[t[0]], b = mesh.vertices[t[2]] - mesh.vertices[t[0]];
    const double up = a[2] * b[0] - a[0] * b[2];
    if (up > 1e-6 * a.norm() * b.norm()) continue;
    for (std::uint32_t& v : t) {
      const auto [copy, is_new] = copies.try_emplace(v, static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(Vec3(mesh.vertices[v]));
      v = copy->second;
    }
  }
  std::vector<Vec3f> normals = compute_vertex_normals(mesh);
  return {std::move(mesh), std::move(normals), {}};
}

void set_finish(const ColliderSettings& s, ColliderView& view) {
  view.colour = s.colour.cast<float>();
  view.material = s.material == "metal" ? MaterialKind::metal : MaterialKind::rock;
  view.specular = s.material == "plastic" ? 1.0f : 0.0f;
  view.roughness = static_cast<float>(s.roughness);
}

void set_environment(const Scene& scene, RenderScene& view) {
  const EnvironmentSettings& s = scene.environment;
  const auto strength = static_cast<float>(s.strength);
  view.show_environment = s.visible.value_or(s.kind != "studio");
  if (s.kind == "studio") {
    for (Vec3f* colour : {&view.sky.zenith, &view.sky.horizon, &view.sky.ground}) *colour *= strength;
  } else if (s.kind == "image") {
    view.environment = {std::make_shared<RadianceImage>(read_radiance(find_mesh(scene, s.image))), s.rotate_deg,
                        strength};
  } else {
    const double elevation = s.sun_elevation_deg * degree, azimuth = s.sun_azimuth_deg * degree;
    const Daylight day{
        {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), -std::cos(elevation) * std::cos(azimuth)},
        s.haze};
    view.environment = {std::make_shared<RadianceImage>(make_sky(day)), 0.0, strength};
    view.sun = make_sun(day);
    view.sun->radiance *= strength;
  }
}

/// Speed of each vertex of a collider whose mesh is `at_rest`, about `time`.
std::vector<Vec3f> vertex_velocities(const Motion<3>& motion, const TriangleMesh& at_rest, double time,
                                     double interval) {
  const Pose<3> before = pose_at(motion, time - 0.5 * interval), after = pose_at(motion, time + 0.5 * interval);
  std::vector<Vec3f> velocities;
  for (const Vec3& x : at_rest.vertices)
    velocities.push_back(((after.to_world(x) - before.to_world(x)) / interval).cast<float>());
  return velocities;
}

std::vector<Vec3f> vertex_velocities(const BodyPose& body, const TriangleMesh& mesh) {
  std::vector<Vec3f> velocities;
  for (const Vec3& x : mesh.vertices)
    velocities.push_back((body.velocity + body.angular_velocity.cross(x - body.centre)).cast<float>());
  return velocities;
}

}  // namespace

RenderScene build_view(const Scene& scene) {
  const auto bodies = import_placed_bodies(scene);
  Box3 bounds;
  for (const TriangleMesh& mesh : bodies)
    for (const Vec3& x : mesh.vertices) bounds.extend(x);
  const auto ground = std::find_if(scene.colliders.begin(), scene.colliders.end(),
                                   [](const ColliderSettings& c) { return c.mesh == "ground"; });
  if (ground != scene.colliders.end()) bounds.lower[1] = std::min(bounds.lower[1], ground->ground_height);

  std::vector<TriangleMesh> obstacles;
  for (std::size_t k = 0; k < scene.colliders.size(); ++k)
    if (scene.colliders[k].mesh != "ground") obstacles.push_back(import_placed_collider(scene, k));
  if (bodies.empty())
    for (const TriangleMesh& mesh : obstacles)
      for (const Vec3& x : mesh.vertices) bounds.extend(x);

  RenderScene view = default_scene(bounds);
  view.look = build_look(scene);
  set_camera(scene, view.camera);
  set_environment(scene, view);
  view.exposure = scene.look.exposure;
  if (!scene.lights.empty() || scene.environment.kind != "studio") view.lights.clear();
  for (const LightSettings& light : scene.lights) view.lights.push_back(to_light(light));
  view.ground.enabled = ground != scene.colliders.end();
  if (view.ground.enabled) {
    view.ground.height = ground->ground_height;
    if (ground->colour != ColliderSettings().colour) view.ground.colour = ground->colour.cast<float>();
  }
  for (const ColliderSettings& collider : scene.colliders)
    if (collider.mesh != "ground") {
      TriangleMesh& mesh = obstacles[view.colliders.size()];
      view.colliders.push_back(is_height_field(collider.mesh) ? terrain_view(std::move(mesh))
                                                              : make_smooth_collider(mesh));
      set_finish(collider, view.colliders.back());
    }
  return view;
}

void place_colliders(const Scene& scene, double time, const std::vector<BodyPose>& bodies,
                     const std::vector<ColliderView>& at_rest, RenderScene& view) {
  std::size_t drawn = 0;
  for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
    const ColliderSettings& collider = scene.colliders[k];
    if (collider.mesh == "ground") {
      if (collider.until) view.ground.enabled = time < *collider.until;
      continue;
    }
    const std::size_t shown = drawn++;
    ColliderView& drawn_view = view.colliders[shown];
    if (collider.until && time >= *collider.until) {
      drawn_view.mesh = {};
      drawn_view.normals.clear();
      drawn_view.velocity.clear();
      continue;
    }
    const TriangleMesh& mesh = at_rest[shown].mesh;
    const auto move_to = [&](const Pose<3>& pose) {
      drawn_view.mesh = moved(mesh, pose);
      for (std::size_t v = 0; v < drawn_view.normals.size(); ++v)
        drawn_view.normals[v] = pose.rotation.cast<float>() * at_rest[shown].normals[v];
    };
    const Motion<3> motion = to_motion(collider, mesh);
    const auto body = std::find_if(bodies.begin(), bodies.end(),
                                   [&](const BodyPose& b) { return b.collider == static_cast<int>(k); });
    if (body != bodies.end()) {
      move_to(body->pose);
      drawn_view.velocity = vertex_velocities(*body, drawn_view.mesh);
    } else if (!motion.still() && !collider.rigid()) {
      move_to(pose_at(motion, time));
      drawn_view.velocity = vertex_velocities(motion, mesh, time, std::max(view.camera.shutter, 1e-3 / scene.shot.fps));
    } else {
      continue;
    }
  }
}

Camera camera_at(const Scene& scene, const Camera& camera, double time) {
  const auto& keys = scene.camera.keyframes;
  if (keys.empty()) return camera;
  const auto at_key = [&](const CameraKeyframeSettings& key) {
    Camera c = camera;
    c.eye = key.eye.value_or(camera.eye);
    c.target = key.target.value_or(camera.target);
    c.vertical_fov_deg = key.vertical_fov_deg.value_or(camera.vertical_fov_deg);
    return c;
  };
  const auto next = std::find_if(keys.begin(), keys.end(), [&](const auto& key) { return key.time > time; });
  if (next == keys.begin()) return at_key(keys.front());
  if (next == keys.end()) return at_key(keys.back());
  const Camera before = at_key(*(next - 1)), after = at_key(*next);
  double t = (time - (next - 1)->time) / (next->time - (next - 1)->time);
  if (scene.camera.interpolation == "smooth") t = t * t * (3.0 - 2.0 * t);
  Camera between = before;
  between.eye = before.eye + t * (after.eye - before.eye);
  between.target = before.target + t * (after.target - before.target);
  between.vertical_fov_deg = before.vertical_fov_deg + t * (after.vertical_fov_deg - before.vertical_fov_deg);
  return between;
}

RenderOptions to_options(const RenderSettings& s) {
  RenderOptions options;
  options.samples = s.samples;
  options.bounces = s.bounces;
  options.firefly_limit = static_cast<float>(s.firefly_limit);
  options.denoise = s.denoise;
  options.seed = static_cast<std::uint32_t>(s.seed);
  options.layers = s.exr;
  return options;
}

}  // namespace smelt
