#pragma once
// Everything a ray can meet, ready for queries.

#include "core/geometry/surface_mesh.h"
#include "render/embree_scene.h"
#include "render/light.h"
#include "render/material.h"
#include "render/scene_view.h"

#include <array>
#include <cstdint>
#include <span>
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
  float specular = 0.0f;  ///< 0: no coat
  float scatter = 0.0f;   ///< [m]
  float fade = 0.0f;      ///< of the floor into the backdrop: 0 floor, 1 backdrop
};

using SurfacePacket = std::array<SurfacePoint, packet_size>;

/// The fluid and the scene around it, placed relative to the camera's eye so that rays are exact near the picture.
/// Keeps references: both arguments must outlive it.
class ShadingScene {
 public:
  /// The scene must have passed check_scene and the mesh check_surface.
  ShadingScene(const SurfaceMesh& fluid, const RenderScene& scene);

  /// Nearest surfaces along the rays.
  SurfacePacket intersect(const RayPacket& rays, bool coherent = false) const;
  /// Nearest triangles alone, floor left out.
  HitPacket intersect_meshes(const RayPacket& rays) const { return embree_.intersect(rays); }
  /// Whether anything blocks each ray.
  std::array<bool, packet_size> occluded(const RayPacket& rays) const;
  /// The surface at a mesh hit.
  SurfacePoint resolve(const Ray& ray, const RayHit& hit) const;

  const RenderScene& view() const { return scene_; }
  std::span<const LampGeometry> lamps() const { return lamps_; }
  const CoatAlbedo& coat_albedo() const { return coat_albedo_; }
  /// How far ray origins are lifted off a surface [m].
  float ray_offset() const { return ray_offset_; }
  const Vec3& origin() const { return origin_; }

 private:
  SurfacePoint floor_point(const Ray& ray, float t) const;
  float floor_distance(const Ray& ray) const;

  const SurfaceMesh& fluid_;
  const RenderScene& scene_;
  Vec3 origin_;
  float floor_height_;
  Vec3f floor_centre_;
  float ray_offset_;
  EmbreeScene embree_;
  std::vector<LampGeometry> lamps_;
  CoatAlbedo coat_albedo_;
};

}  // namespace smelt
