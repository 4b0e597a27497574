#pragma once
// Everything a ray can meet, ready for queries.

#include "core/geometry/surface_mesh.h"
#include "render/black_body.h"
#include "render/embree_scene.h"
#include "render/light_set.h"
#include "render/material.h"
#include "render/scene_view.h"

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace smelt {

enum class SurfaceKind : std::uint8_t { none, fluid, collider, ground };

/// Where a ray ends and what is there. Positions are relative to ShadingScene::origin.
struct SurfacePoint {
  SurfaceKind kind = SurfaceKind::none;
  float t = 0.0f;  ///< along the ray [m]
  Vec3f position = Vec3f::Zero();
  Vec3f normal = Vec3f::UnitY();            ///< interpolated, on the side the ray came from
  Vec3f geometric_normal = Vec3f::UnitY();  ///< of the triangle, same side
  Vec3f albedo = Vec3f::Zero();
  float roughness = 1.0f;
  float specular = 0.0f;                                        ///< 0: no coat
  float scatter = 0.0f;                                         ///< [m]
  float fade = 0.0f;                                            ///< of the floor into the backdrop: 0 floor, 1 backdrop
  bool metal = false;                                           ///< mirrors with reflectance `albedo`, and has no body
  Vec3f emission = Vec3f::Zero();                               ///< radiance of its own
  float temperature = std::numeric_limits<float>::quiet_NaN();  ///< of its skin [K]; not a number where unknown
  Vec3f velocity = Vec3f::Zero();                               ///< [m/s]
  std::uint32_t triangle = 0;                                   ///< of the fluid or the collider
};

using SurfacePacket = std::array<SurfacePoint, packet_size>;

/// The fluid and the scene around it, placed relative to the camera's eye so that rays are exact near the picture.
/// Keeps references: both arguments must outlive it.
class ShadingScene {
 public:
  /// The scene must have passed check_scene and the mesh check_surface.
  ShadingScene(const SurfaceMesh& fluid, const RenderScene& scene);

  /// Nearest surfaces along the rays; `coherent`: the rays run side by side from the camera, and see relief.
  SurfacePacket intersect(const RayPacket& rays, bool coherent = false) const;
  /// Nearest triangles alone, floor left out.
  HitPacket intersect_meshes(const RayPacket& rays) const { return embree_.intersect(rays); }
  /// Whether anything blocks each ray.
  std::array<bool, packet_size> occluded(const RayPacket& rays) const;
  /// The surface at a mesh hit; `relief`: with the normal that a crust's relief gives it.
  SurfacePoint resolve(const Ray& ray, const RayHit& hit, bool relief = false) const;
  /// A light's direction as seen from a surface, with what it sends; a glow is where it is at `time` of the shutter.
  LightSample sample_light(const Vec3f& point, Sample2 where, float which, float time) const;
  /// Radiance that the camera sees behind everything.
  Vec3f background(const Vec3f& direction) const;

  const RenderScene& view() const { return scene_; }
  const SurfaceMesh& fluid() const { return fluid_; }
  const LightSet& lights() const { return lights_; }
  const CoatAlbedo& coat_albedo() const { return coat_albedo_; }
  const CoatAlbedo& mirror_albedo() const { return mirror_albedo_; }
  /// How far ray origins are lifted off a surface [m].
  float ray_offset() const { return ray_offset_; }
  const Vec3& origin() const { return origin_; }

 private:
  SurfacePoint floor_point(const Ray& ray, float t) const;
  float floor_distance(const Ray& ray) const;
  void shade_fluid(SurfacePoint& point, const MeshPoint& at, bool relief) const;
  void raise_relief(SurfacePoint& point, const MeshPoint& at, float solid, float height) const;
  Vec3f fluid_position(const MeshPoint& at) const;
  GlowLight gather_glow() const;

  const SurfaceMesh& fluid_;
  const RenderScene& scene_;
  Vec3 origin_;
  float floor_height_;
  Vec3f floor_centre_;
  float ray_offset_;
  EmbreeScene embree_;
  BlackBodyTable black_body_;
  LightSet lights_;
  CoatAlbedo coat_albedo_;
  CoatAlbedo mirror_albedo_;
};

}  // namespace smelt
