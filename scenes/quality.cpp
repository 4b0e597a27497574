#include "scenes/quality.h"

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

constexpr double preview_coarsening = 4.0;  ///< particles for one

void set_preview(Scene& scene) {
  scene.time_step.courant = 0.4;
  scene.surface.cell_over_spacing = 0.75;
  scene.surface.anisotropic = false;
  scene.surface.smoothing_passes = 15;
  scene.camera.width = 640;
  scene.camera.height = 360;
  scene.render.samples = 1;
}

void set_final(Scene& scene) {
  scene.render.samples = 32;
  scene.render.bounces = 3;
}

/// As the cases of known answers are computed that docs/accuracy.md lists.
void set_study(Scene& scene) {
  scene.particles.smoothing_length_over_spacing = 1.3;
  scene.solver.precision = "double";
  scene.solver.xsph = 0.0;
  scene.time_step.courant = 0.2;
}

}  // namespace

void set_defaults_for(std::string_view quality, Scene& scene) {
  if (quality == "preview") set_preview(scene);
  if (quality == "final") set_final(scene);
  if (quality == "study") set_study(scene);
}

void apply_quality(Scene& scene) {
  if (scene.shot.quality == "preview") {
    ParticleSettings& p = scene.particles;
    if (p.count) p.count = std::max<std::int64_t>(1, std::llround(static_cast<double>(*p.count) / preview_coarsening));
    if (p.spacing) *p.spacing *= std::cbrt(preview_coarsening);
  }
  scene.shot.quality.reset();
}

}  // namespace smelt
