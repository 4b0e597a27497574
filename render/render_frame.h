#pragma once
// Mesh and scene to picture.

#include "core/geometry/surface_mesh.h"
#include "core/image.h"
#include "render/scene_view.h"

#include <cstdint>

namespace smelt {

struct RenderOptions {
  int samples = 2;      ///< per pixel, at least 16 on silhouettes; powers of two spread best; in [1, 4096]
  bool denoise = true;  ///< edge-preserving filter on the light (render/denoise.h)
  bool moving_noise =
      false;  ///< a new noise pattern every frame; false keeps what is left of it still, so it does not flicker
  std::uint32_t seed = 1;  ///< of the noise pattern
};

/// Draws the fluid as `scene.look` says, on `scene.ground`, by path tracing with one diffuse bounce and one reflection
/// (docs/decisions/0005-renderer.md); tone-mapped 8-bit sRGB of the camera's size. `fluid` may be empty; its normals
/// may be empty (facets) and its temperatures too (cold). The same input gives the same bytes on any number of threads.
/// Throws Error on what check_scene refuses, on attributes that do not fit the mesh, and on a camera inside the fluid.
ImageRgb8 render_frame(const SurfaceMesh& fluid, const RenderScene& scene, const RenderOptions& options,
                       std::int32_t frame);

}  // namespace smelt
