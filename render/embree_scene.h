#pragma once
// Rays against triangles and spheres, eight at a time.

#include "core/geometry/triangle_mesh.h"
#include "core/geometry/vec.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>

namespace smelt {

inline constexpr std::size_t packet_size = 8;

struct Ray {
  Vec3f origin = Vec3f::Zero();
  Vec3f direction = Vec3f::UnitY();
  float t_near = 0.0f;
  float t_far = std::numeric_limits<float>::infinity();
  float time = 0.5f;    ///< when, within the shutter's time: 0 at its start, 1 at its end
  bool active = false;  ///< inactive rays hit nothing
  bool meshes = true;   ///< false: known to miss all meshes
};

struct RayHit {
  int geometry = -1;  ///< as numbered by add_mesh, -1: nothing was hit
  std::uint32_t triangle = 0;
  float t = std::numeric_limits<float>::infinity();
  float u = 0.0f, v = 0.0f;      ///< the point is (1-u-v) a + u b + v c
  Vec3f normal = Vec3f::Zero();  ///< of the triangle by its winding, not unit; zero without area
};

using RayPacket = std::array<Ray, packet_size>;
using HitPacket = std::array<RayHit, packet_size>;

/// Owns an Embree device and scene. Built once: add the meshes, commit, then query from any number of threads.
class EmbreeScene {
 public:
  /// Throws Error where the machine has no memory left for it.
  EmbreeScene();
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// Adds a copy of the mesh, moved by -origin [m] (rays live in floats, so keep them near zero). Returns its number,
  /// counted from 0. An empty mesh takes a number too. While the shutter is open, for `shutter` [s], vertices move with
  /// their `velocity` [m/s] (empty: they stand still), and are half-way where the mesh says.
  int add_mesh(const TriangleMesh& mesh, const Vec3& origin, std::span<const Vec3f> velocity = {},
               float shutter = 0.0f);
  /// Adds spheres of one radius [m], moved by -origin. A hit's `triangle` is the number of its sphere.
  int add_spheres(std::span<const Vec3> centres, double radius, const Vec3& origin);
  /// Builds the hierarchy.
  void commit();

  /// Nearest hits. `coherent`: the rays run side by side.
  HitPacket intersect(const RayPacket& rays, bool coherent = false) const;
  /// Whether anything lies on each ray; false for inactive rays.
  std::array<bool, packet_size> occluded(const RayPacket& rays) const;

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

}  // namespace smelt
