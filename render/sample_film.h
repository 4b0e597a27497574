#pragma once
// Sends camera rays where they are needed.

#include "render/film.h"
#include "render/render_frame.h"
#include "render/shading_scene.h"

#include <cstdint>

namespace smelt {

/// Fills a film of the camera's size with `options.samples` a pixel: fewer where the floor fades, at least 16 at
/// silhouettes and creases. Which is which is decided by one ray through the middle of each pixel and its eight
/// neighbours.
Film sample_film(const ShadingScene& scene, const RenderOptions& options, std::int32_t frame);

}  // namespace smelt
