#pragma once
// Mesh and scene to picture.

#include "core/geometry/surface_mesh.h"
#include "core/image.h"
#include "render/film.h"
#include "render/scene_view.h"

#include <cstdint>

namespace smelt {

struct RenderOptions {
  int samples = 2;  ///< per pixel, at least 16 on silhouettes; powers of two spread best; in [1, 4096]
  int bounces = 1;  ///< surfaces that light may meet after the one that is seen; in [1, 24]
  /// Luminance, as displayed, that one path may bring from its bounces at most; 0: no limit. What it takes away makes
  /// the picture darker by Film::clamped.
  float firefly_limit = 16.0f;
  bool denoise = true;  ///< edge-preserving filter on the light (render/denoise.h)
  bool moving_noise =
      false;  ///< a new noise pattern every frame; false keeps what is left of it still, so it does not flicker
  std::uint32_t seed = 1;  ///< of the noise pattern
  bool layers = false;     ///< keep what compositing needs (Film::layers)
};

/// Draws the fluid as `scene.look` says, on `scene.ground`, by path tracing (docs/decisions/0005-renderer.md,
/// 0025-paths.md), and filters what noise is left. `fluid` may be empty; its normals may be empty (facets) and its
/// temperatures too (cold). The same input gives the same bytes on any number of threads. Throws Error on what
/// check_scene refuses, on attributes that do not fit the mesh or that the look needs and the mesh lacks, and on a
/// camera inside the fluid.
Film render_film(const SurfaceMesh& fluid, const RenderScene& scene, const RenderOptions& options, std::int32_t frame);

/// Radiance of a pixel, unexposed.
Vec3f radiance_at(const Film& film, std::size_t pixel);

/// Tone-mapped sRGB, dithered to 8 bits or rounded to 16.
ImageRgb8 develop8(const Film& film, double exposure, ToneCurve curve = ToneCurve::neutral);
ImageRgb16 develop16(const Film& film, double exposure, ToneCurve curve = ToneCurve::neutral);

/// The picture and its layers, linear and unexposed, named as OpenEXR does: R, G, B, A; albedo.R, .G, .B; depth.Z;
/// normal.X, .Y, .Z; position.X, .Y, .Z in the world [m]; temperature.T [K]; velocity.X, .Y, .Z [m/s]. The film must
/// have its layers.
LayeredImage to_layers(const Film& film, const Vec3& eye);

/// Luminance that the firefly limit took away, over what there was.
double clamped_share(const Film& film);

/// render_film() and develop8() in one.
ImageRgb8 render_frame(const SurfaceMesh& fluid, const RenderScene& scene, const RenderOptions& options,
                       std::int32_t frame);

}  // namespace smelt
