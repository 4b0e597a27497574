#pragma once
// The furnace: a room that is white in every direction, and a sphere to stand in it.

#include "core/geometry/surface_mesh.h"
#include "render/scene_view.h"

#include <cmath>
#include <cstdint>
#include <numbers>

namespace smelt::furnace {

/// A closed sphere of 2 n^2 quads, outward, with exact normals.
inline SurfaceMesh make_sphere(double radius, const Vec3& centre, int n) {
  SurfaceMesh sphere;
  const int n_around = 2 * n;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j < n_around; ++j) {
      const double theta = std::numbers::pi * i / n, phi = 2.0 * std::numbers::pi * j / n_around;
      const Vec3 d(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
      sphere.mesh.vertices.push_back(centre + radius * d);
      sphere.normals.push_back(d.cast<float>());
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n_around; ++j) {
      const auto at = [&](int a, int b) { return static_cast<std::uint32_t>(a * n_around + b % n_around); };
      if (i > 0) sphere.mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i < n - 1) sphere.mesh.triangles.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
    }
  }
  return sphere;
}

/// Nothing but a sky of radiance 1 in every direction, seen by a small camera that looks along -z at the origin.
inline RenderScene white_room(int width, int height) {
  RenderScene scene;
  scene.camera.eye = Vec3(0.0, 0.0, 5.0);
  scene.camera.target = Vec3::Zero();
  scene.camera.vertical_fov_deg = 30.0;
  scene.camera.width = width;
  scene.camera.height = height;
  scene.sky = {Vec3f::Ones(), Vec3f::Ones(), Vec3f::Ones()};
  scene.backdrop.low = scene.backdrop.high = Vec3f::Ones();
  scene.ground.enabled = false;
  scene.look.cold = {Vec3f::Ones(), 0.5f, 0.0f};
  return scene;
}

}  // namespace smelt::furnace
