#include "render/shading_scene.h"

#include "render/sky.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace smelt {

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// Unit vector, or `otherwise` where `v` has no direction.
Vec3f normalized_or(const Vec3f& v, const Vec3f& otherwise) {
  const float n2 = v.squaredNorm();
  return n2 > 1e-30f && std::isfinite(n2) ? Vec3f(v / std::sqrt(n2)) : otherwise;
}

Vec3f interpolate(const std::vector<Vec3f>& values, const std::array<std::uint32_t, 3>& triangle, const RayHit& hit) {
  return values[triangle[0]] * (1.0f - hit.u - hit.v) + values[triangle[1]] * hit.u + values[triangle[2]] * hit.v;
}

/// Size of what is drawn [m], for lengths that must be small beside it.
double scene_size(const SurfaceMesh& fluid, const RenderScene& scene) {
  Box3 bounds;
  for (const Vec3& vertex : fluid.mesh.vertices) bounds.extend(vertex);
  for (const ColliderView& collider : scene.colliders) {
    for (const Vec3& vertex : collider.mesh.vertices) bounds.extend(vertex);
  }
  const double view = (scene.camera.target - scene.camera.eye).norm();
  return bounds.empty() ? view : std::min(view, bounds.extent().norm());
}

}  // namespace

ShadingScene::ShadingScene(const SurfaceMesh& fluid, const RenderScene& scene)
    : fluid_(fluid),
      scene_(scene),
      origin_(scene.camera.eye),
      floor_height_(static_cast<float>(scene.ground.height - origin_.y())),
      floor_centre_((scene.ground.centre - origin_).cast<float>()),
      ray_offset_(static_cast<float>(5e-5 * scene_size(fluid, scene))),
      coat_albedo_(scene.look.ior) {
  embree_.add_mesh(fluid.mesh, origin_);
  for (const ColliderView& collider : scene.colliders) embree_.add_mesh(collider.mesh, origin_);
  embree_.commit();
  for (const AreaLight& light : scene.lights) lamps_.push_back(place_lamp(light, origin_));
}

float ShadingScene::floor_distance(const Ray& ray) const {
  if (!ray.active || !scene_.ground.enabled) return infinity;
  // From either side: a mesh that dips below the floor still meets it.
  const float t = (floor_height_ - ray.origin.y()) / ray.direction.y();
  return t > ray.t_near && t < ray.t_far && t > 0.0f ? t : infinity;
}

SurfacePoint ShadingScene::floor_point(const Ray& ray, float t) const {
  SurfacePoint point;
  point.kind = SurfaceKind::ground;
  point.t = t;
  point.position = ray.origin + ray.direction * t;
  point.position.y() = floor_height_;
  const Vec3f from_centre = point.position - floor_centre_;
  const float distance = std::sqrt(from_centre.x() * from_centre.x() + from_centre.z() * from_centre.z());
  point.fade =
      smooth_step(static_cast<float>(scene_.ground.fade_start), static_cast<float>(scene_.ground.fade_end), distance);
  point.albedo = scene_.ground.colour;
  if (ray.direction.y() > 0.0f) point.normal = point.geometric_normal = -Vec3f::UnitY();
  return point;
}

SurfacePoint ShadingScene::resolve(const Ray& ray, const RayHit& hit) const {
  const bool is_fluid = hit.geometry == 0;
  const ColliderView* collider = is_fluid ? nullptr : &scene_.colliders[static_cast<std::size_t>(hit.geometry - 1)];
  const TriangleMesh& mesh = is_fluid ? fluid_.mesh : collider->mesh;
  const std::vector<Vec3f>& normals = is_fluid ? fluid_.normals : collider->normals;
  const auto& triangle = mesh.triangles[hit.triangle];

  SurfacePoint point;
  point.kind = is_fluid ? SurfaceKind::fluid : SurfaceKind::collider;
  point.t = hit.t;
  point.position = ray.origin + ray.direction * hit.t;
  point.geometric_normal = normalized_or(hit.normal, -ray.direction);
  point.normal = point.geometric_normal;
  if (!normals.empty()) point.normal = normalized_or(interpolate(normals, triangle, hit), point.geometric_normal);
  // Sheets are drawn from both sides; the interpolated normal follows the triangle's.
  if (point.geometric_normal.dot(ray.direction) > 0.0f) point.geometric_normal = -point.geometric_normal;
  if (point.normal.dot(point.geometric_normal) < 0.0f) point.normal = -point.normal;

  if (!is_fluid) {
    point.albedo = collider->colour;
    return point;
  }
  float temperature = std::numeric_limits<float>::quiet_NaN();
  if (const auto& t = fluid_.temperature; !t.empty()) {
    temperature = t[triangle[0]] * (1.0f - hit.u - hit.v) + t[triangle[1]] * hit.u + t[triangle[2]] * hit.v;
  }
  const Wax wax = blend_look(scene_.look, temperature);
  point.albedo = wax.base_colour;
  point.roughness = wax.roughness;
  point.scatter = wax.scatter_m;
  point.specular = scene_.look.specular;
  return point;
}

SurfacePacket ShadingScene::intersect(const RayPacket& rays, bool coherent) const {
  const HitPacket hits = embree_.intersect(rays, coherent);
  SurfacePacket points;
  for (std::size_t i = 0; i < packet_size; ++i) {
    const float floor = floor_distance(rays[i]);
    if (hits[i].geometry >= 0 && hits[i].t <= floor) {
      points[i] = resolve(rays[i], hits[i]);
    } else if (floor < infinity) {
      points[i] = floor_point(rays[i], floor);
    }
  }
  return points;
}

std::array<bool, packet_size> ShadingScene::occluded(const RayPacket& rays) const {
  std::array<bool, packet_size> blocked{};
  RayPacket rest = rays;
  for (std::size_t i = 0; i < packet_size; ++i) {
    blocked[i] = floor_distance(rays[i]) < infinity;
    rest[i].active = rays[i].active && !blocked[i];
  }
  const std::array<bool, packet_size> by_mesh = embree_.occluded(rest);
  for (std::size_t i = 0; i < packet_size; ++i) blocked[i] = blocked[i] || by_mesh[i];
  return blocked;
}

}  // namespace smelt
