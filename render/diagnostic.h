#pragma once
// Particles as what they are: spheres coloured by a number, with colliders, scale and time.

#include "core/geometry/surface_mesh.h"
#include "core/image.h"
#include "render/colour_bar.h"
#include "render/scene_view.h"

#include <span>
#include <string>

namespace smelt {

/// How the fluid's surface is shown with its particles.
enum class SurfaceOverlay { none, wire, translucent };

struct DiagnosticPicture {
  std::span<const Vec3> position;  ///< of the particles [m]
  std::span<const float> value;    ///< one a particle, in the scale's unit
  double radius = 0.0;             ///< of a particle [m]
  ColourScale scale;
  std::string stamp;                     ///< top left: shot, frame, time
  const SurfaceMesh* surface = nullptr;  ///< for an overlay
  SurfaceOverlay overlay = SurfaceOverlay::none;
};

/// Draws the particles, colliders and ground of `scene` from its camera, lit from the eye and from above, on white;
/// four rays a pixel through Embree (docs/decisions/0026-diagnostic-view.md). The same input gives the same bytes on
/// any number of threads. Throws Error on what check_scene refuses.
ImageRgb8 draw_diagnostic(const DiagnosticPicture& picture, const RenderScene& scene);

}  // namespace smelt
