#include "render/shading_scene.h"

#include "render/crust.h"
#include "render/sky.h"

#include <Eigen/Geometry>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

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

template <typename Value>
Value interpolate(const std::vector<Value>& values, const std::array<std::uint32_t, 3>& triangle, const MeshPoint& at) {
  return values[triangle[0]] * (1.0f - at.u - at.v) + values[triangle[1]] * at.u + values[triangle[2]] * at.v;
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
      lights_(scene, origin_, gather_glow()),
      coat_albedo_(scene.look.ior),
      mirror_albedo_(CoatAlbedo::perfect_mirror()) {
  const auto shutter = static_cast<float>(scene.camera.shutter);
  embree_.add_mesh(fluid.mesh, origin_, fluid.velocity, shutter);
  for (const ColliderView& collider : scene.colliders)
    embree_.add_mesh(collider.mesh, origin_, collider.velocity, shutter);
  embree_.commit();
}

Vec3f ShadingScene::fluid_position(const MeshPoint& at) const {
  const auto& t = fluid_.mesh.triangles[at.triangle];
  const auto corner = [&](int k) -> Vec3 { return fluid_.mesh.vertices[t[static_cast<std::size_t>(k)]] - origin_; };
  return (corner(0) * (1.0 - static_cast<double>(at.u) - static_cast<double>(at.v)) +
          corner(1) * static_cast<double>(at.u) + corner(2) * static_cast<double>(at.v))
      .cast<float>();
}

GlowLight ShadingScene::gather_glow() const {
  if (!scene_.look.black_body || fluid_.temperature.empty()) return {};
  const std::size_t n = fluid_.mesh.triangles.size();
  std::vector<float> power(n), area(n);
  std::vector<Vec3f> middle(n);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 1024), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t k = range.begin(); k < range.end(); ++k) {
      const auto triangle = static_cast<std::uint32_t>(k);
      const auto at = [&](float u, float v) { return fluid_position({triangle, u, v}); };
      const Vec3f a = at(0.0f, 0.0f);
      area[k] = 0.5f * (at(1.0f, 0.0f) - a).cross(at(0.0f, 1.0f) - a).norm();
      middle[k] = at(1.0f / 3.0f, 1.0f / 3.0f);
      // Half by what its middle gives off, half as if it had no crust: no place that glows is left out.
      SurfacePoint point;
      shade_fluid(point, {triangle, 1.0f / 3.0f, 1.0f / 3.0f}, false);
      float hottest = 0.0f;
      for (const std::uint32_t vertex : fluid_.mesh.triangles[k])
        hottest = std::max(hottest, fluid_.temperature[vertex]);
      const Vec3f bare =
          black_body_(hottest) * (scene_.look.black_body->emissivity / scene_.look.black_body->white_cd_m2);
      power[k] = area[k] * 0.5f * (point.emission.sum() + bare.sum());
    }
  });
  return GlowLight(power, std::move(area), middle);
}

LightSample ShadingScene::sample_light(const Vec3f& point, Sample2 where, float which, float time) const {
  LightSample sample = lights_.sample(point, where, which);
  if (!sample.glow) return sample;
  const MeshPoint at = *sample.glow;
  const auto& t = fluid_.mesh.triangles[at.triangle];
  Vec3f to_place = fluid_position(at) - point;
  Vec3f edge1 = (fluid_.mesh.vertices[t[1]] - fluid_.mesh.vertices[t[0]]).cast<float>();
  Vec3f edge2 = (fluid_.mesh.vertices[t[2]] - fluid_.mesh.vertices[t[0]]).cast<float>();
  if (scene_.camera.shutter > 0.0 && !fluid_.velocity.empty()) {  // where the rays find it at that time
    const float since = (time - 0.5f) * static_cast<float>(scene_.camera.shutter);
    const Vec3f way[3] = {since * fluid_.velocity[t[0]], since * fluid_.velocity[t[1]], since * fluid_.velocity[t[2]]};
    to_place += (1.0f - at.u - at.v) * way[0] + at.u * way[1] + at.v * way[2];
    edge1 += way[1] - way[0];
    edge2 += way[2] - way[0];
  }
  sample.distance = to_place.norm();
  if (sample.distance <= 0.0f) return {};
  sample.direction = to_place / sample.distance;
  const float cosine = -sample.direction.dot(normalized_or(edge1.cross(edge2), Vec3f::Zero()));
  if (cosine <= 1e-6f) return {};
  sample.pdf *= lights_.glow_pdf_area(at.triangle) * sample.distance * sample.distance / cosine;
  SurfacePoint place;
  shade_fluid(place, at, false);
  sample.radiance = place.emission;
  return sample;
}

Vec3f ShadingScene::background(const Vec3f& direction) const {
  return scene_.show_environment ? lights_.far_radiance(direction) : backdrop_radiance(scene_.backdrop, direction);
}

void ShadingScene::shade_fluid(SurfacePoint& point, const MeshPoint& at, bool relief) const {
  const auto& triangle = fluid_.mesh.triangles[at.triangle];
  const Look& look = scene_.look;
  float temperature = std::numeric_limits<float>::quiet_NaN(), solid = 1.0f;
  if (!fluid_.temperature.empty()) {
    temperature = interpolate(fluid_.temperature, triangle, at);
    solid = 1.0f - smooth_step(look.cold_K, look.hot_K, temperature);
  }
  float tone = 0.0f;
  if (look.crust) {
    const CrustSample crust = sample_crust(*look.crust, interpolate(fluid_.rest, triangle, at), solid);
    temperature -= crust_cooling(*look.crust, crust.cover, solid);
    tone = crust.tone;
    if (relief && look.crust->relief > 0.0f) raise_relief(point, at, solid, crust.height);
  }
  const Wax wax = blend_look(look, temperature);
  point.albedo = (wax.base_colour * (1.0f + 0.35f * tone)).cwiseMax(0.0f).cwiseMin(1.0f);
  point.roughness = wax.roughness;
  point.scatter = look.material == MaterialKind::wax ? wax.scatter_m : 0.0f;
  point.metal = look.material == MaterialKind::metal;
  point.specular = look.specular;
  point.temperature = temperature;
  if (look.black_body)
    point.emission = black_body_(temperature) * (look.black_body->emissivity / look.black_body->white_cd_m2);
}

/// Leans the normal by the slope of the relief: height over the two edges of the triangle, by differences along them.
void ShadingScene::raise_relief(SurfacePoint& point, const MeshPoint& at, float solid, float height) const {
  const auto& t = fluid_.mesh.triangles[at.triangle];
  const Vec3f rest = interpolate(fluid_.rest, t, at);
  const auto slope_along = [&](std::size_t k) {
    const Vec3f along = fluid_.rest[t[k]] - fluid_.rest[t[0]];
    const float length = along.norm();
    if (!(length > 0.0f)) return 0.0f;
    const float step = 0.02f * scene_.look.crust->plate_m / length;
    return (sample_crust(*scene_.look.crust, rest + step * along, solid).height - height) / step;
  };
  const Vec3f edge1 = (fluid_.mesh.vertices[t[1]] - fluid_.mesh.vertices[t[0]]).cast<float>();
  const Vec3f edge2 = (fluid_.mesh.vertices[t[2]] - fluid_.mesh.vertices[t[0]]).cast<float>();
  const float a = edge1.squaredNorm(), b = edge1.dot(edge2), c = edge2.squaredNorm(), det = a * c - b * b;
  if (!(det > 1e-12f * a * c)) return;
  const float d1 = slope_along(1), d2 = slope_along(2);
  Vec3f gradient = edge1 * ((c * d1 - b * d2) / det) + edge2 * ((a * d2 - b * d1) / det);
  // Where the material was torn, neighbouring places lie far apart in it: no cliffs there.
  const float steep = gradient.norm();
  if (steep > 1.5f) gradient *= 1.5f / steep;
  const Vec3f leaned = normalized_or(point.normal - gradient, point.normal);
  if (leaned.dot(point.geometric_normal) > 0.05f) point.normal = leaned;
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

SurfacePoint ShadingScene::resolve(const Ray& ray, const RayHit& hit, bool relief) const {
  const bool is_fluid = hit.geometry == 0;
  const ColliderView* collider = is_fluid ? nullptr : &scene_.colliders[static_cast<std::size_t>(hit.geometry - 1)];
  const TriangleMesh& mesh = is_fluid ? fluid_.mesh : collider->mesh;
  const std::vector<Vec3f>& normals = is_fluid ? fluid_.normals : collider->normals;
  const auto& triangle = mesh.triangles[hit.triangle];
  const MeshPoint at{hit.triangle, hit.u, hit.v};

  SurfacePoint point;
  point.kind = is_fluid ? SurfaceKind::fluid : SurfaceKind::collider;
  point.t = hit.t;
  point.position = ray.origin + ray.direction * hit.t;
  point.geometric_normal = normalized_or(hit.normal, -ray.direction);
  point.normal = point.geometric_normal;
  if (!normals.empty()) point.normal = normalized_or(interpolate(normals, triangle, at), point.geometric_normal);
  // Sheets are drawn from both sides; the interpolated normal follows the triangle's.
  if (point.geometric_normal.dot(ray.direction) > 0.0f) point.geometric_normal = -point.geometric_normal;
  if (point.normal.dot(point.geometric_normal) < 0.0f) point.normal = -point.normal;

  point.triangle = hit.triangle;
  const std::vector<Vec3f>& velocity = is_fluid ? fluid_.velocity : collider->velocity;
  if (!velocity.empty()) point.velocity = interpolate(velocity, triangle, at);
  if (is_fluid) {
    shade_fluid(point, at, relief);
    return point;
  }
  point.albedo = collider->colour;
  point.metal = collider->material == MaterialKind::metal;
  point.roughness = collider->roughness;
  point.specular = collider->specular;
  return point;
}

SurfacePacket ShadingScene::intersect(const RayPacket& rays, bool coherent) const {
  const HitPacket hits = embree_.intersect(rays, coherent);
  SurfacePacket points;
  for (std::size_t i = 0; i < packet_size; ++i) {
    const float floor = floor_distance(rays[i]);
    if (hits[i].geometry >= 0 && hits[i].t <= floor) {
      points[i] = resolve(rays[i], hits[i], coherent);
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
