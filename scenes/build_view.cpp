#include "scenes/build_view.h"

#include "io/height_field.h"
#include "scenes/build_simulation.h"
#include "surfacing/smooth_mesh.h"

#include "scenes/build_simulation.h"
#include "scenes/collider_motion.h"

#include <algorithm>
#include <map>

namespace smelt {

namespace {

Wax to_wax(const LookSettings::State& state) {
  return {state.colour.cast<float>(), static_cast<float>(state.roughness), static_cast<float>(state.scatter)};
}

void set_look(const Scene& scene, Look& look) {
  look.cold = to_wax(scene.look.cold);
  look.hot = to_wax(scene.look.hot);
  look.specular = static_cast<float>(scene.look.specular);
  look.ior = static_cast<float>(scene.look.ior);
  if (const auto& heat = scene.materials.front().heat) {
    look.cold_K = static_cast<float>(heat->cold);
    look.hot_K = static_cast<float>(heat->hot);
  }
  if (scene.look.cold_K) look.cold_K = static_cast<float>(*scene.look.cold_K);
  if (scene.look.hot_K) look.hot_K = static_cast<float>(*scene.look.hot_K);
}

void set_camera(const CameraSettings& settings, Camera& camera) {
  camera.eye = settings.eye.value_or(camera.eye);
  camera.target = settings.target.value_or(camera.target);
  camera.vertical_fov_deg = settings.vertical_fov_deg.value_or(camera.vertical_fov_deg);
  camera.width = settings.width;
  camera.height = settings.height;
}

AreaLight to_light(const LightSettings& s) {
  return {s.shape == "disk" ? LightShape::disk : LightShape::rectangle, s.position, s.target, s.width, s.height,
          s.radiance.cast<float>()};
}

/// A terrain's surface is drawn smooth, its walls and bottom are not smoothed into it: their corners are made vertices of their own.
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
  set_look(scene, view.look);
  set_camera(scene.camera, view.camera);
  view.exposure = scene.look.exposure;
  if (!scene.lights.empty()) view.lights.clear();
  for (const LightSettings& light : scene.lights) view.lights.push_back(to_light(light));
  view.ground.enabled = ground != scene.colliders.end();
  if (view.ground.enabled) view.ground.height = ground->ground_height;
  for (const ColliderSettings& collider : scene.colliders)
    if (collider.mesh != "ground") {
      TriangleMesh& mesh = obstacles[view.colliders.size()];
      view.colliders.push_back(is_height_field(collider.mesh) ? terrain_view(std::move(mesh)) : ColliderView{std::move(mesh), {}, {}});
      view.colliders.back().colour = collider.colour.cast<float>();
    }
  return view;
}

void place_colliders(const Scene& scene, double time, const std::vector<BodyPose>& bodies,
                     const std::vector<ColliderView>& at_rest, RenderScene& view) {
  std::size_t drawn = 0;
  for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
    const ColliderSettings& collider = scene.colliders[k];
    if (collider.mesh == "ground") continue;
    const std::size_t shown = drawn++;
    ColliderView& drawn_view = view.colliders[shown];
    if (collider.until && time >= *collider.until) {
      drawn_view.mesh = {};
      drawn_view.normals.clear();
      continue;
    }
    const TriangleMesh& mesh = at_rest[shown].mesh;
    const Motion<3> motion = to_motion(collider, mesh);
    const auto body = std::find_if(bodies.begin(), bodies.end(), [&](const BodyPose& b) { return b.collider == static_cast<int>(k); });
    if (body != bodies.end())
      drawn_view.mesh = moved(mesh, body->pose);
    else if (!motion.still() && !collider.rigid())
      drawn_view.mesh = moved(mesh, pose_at(motion, time));
    else
      continue;
    if (!at_rest[shown].normals.empty()) drawn_view.normals = compute_vertex_normals(drawn_view.mesh);
  }
}

}  // namespace smelt
