#include "core/error.h"
#include "core/sph/equation_of_state.h"
#include "io/atomic_file.h"
#include "io/particles_vdb.h"
#include "io/png.h"
#include "io/surface_vdb.h"
#include "render/contact_sheet.h"
#include "render/diagnostic.h"
#include "scenes/build_simulation.h"
#include "scenes/build_view.h"
#include "scenes/failed_frames.h"
#include "scenes/stage_frames.h"
#include "scenes/stages.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace smelt {

namespace {

/// A number that particles have.
struct Quantity {
  std::string label;
  bool logarithmic = false;
  std::function<std::vector<float>(const ParticleFrame&)> values;
};

std::vector<float> require(const std::vector<float>& values, std::size_t n, const std::string& name) {
  if (values.size() != n)
    fail("--colour-by {0}: the particles have no {0}, as the scene has none; choose density or speed", name);
  return values;
}

/// Pressure is not in the caches: it follows from the density by the scene's equation of state.
Quantity pressure_of(const Scene& scene) {
  const double density = scene.materials.front().density;
  for (const MaterialSettings& material : scene.materials)
    if (material.density != density)
      fail(
          "--colour-by pressure: the scene's materials differ in density, and caches do not say which particle is of "
          "which; choose density");
  const double c =
      scene.solver.sound_speed ? *scene.solver.sound_speed : build_simulation(scene).parameters.sound_speed;
  EquationOfState state;
  state.law = scene.solver.equation_of_state == "tait" ? PressureLaw::tait : PressureLaw::linear;
  state.background_pressure = scene.solver.background_pressure;
  return {"pressure [Pa]", false, [=](const ParticleFrame& p) {
            std::vector<float> values;
            for (const float rho : p.density)
              values.push_back(static_cast<float>(compute_pressure(state, c, density, static_cast<double>(rho), 0.0)));
            return values;
          }};
}

Quantity to_quantity(const Scene& scene, const std::string& name) {
  if (name == "temperature")
    return {"temperature [K]", false,
            [](const ParticleFrame& p) { return require(p.temperature, p.size(), "temperature"); }};
  if (name == "viscosity")
    return {"viscosity [Pa s]", true,
            [](const ParticleFrame& p) { return require(p.viscosity, p.size(), "viscosity"); }};
  if (name == "density") return {"density [kg/m3]", false, [](const ParticleFrame& p) { return p.density; }};
  if (name == "pressure") return pressure_of(scene);
  CHECK_EQ(name, "speed");
  return {"speed [m/s]", false, [](const ParticleFrame& p) {
            std::vector<float> values;
            for (const Vec3f& v : p.velocity) values.push_back(v.norm());
            return values;
          }};
}

/// Least and greatest value, none of them infinite.
struct Extremes {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void extend(const std::vector<float>& values, bool logarithmic) {
    for (const float value : values) {
      if (!std::isfinite(value) || (logarithmic && !(value > 0.0f))) continue;
      low = std::min(low, static_cast<double>(value));
      high = std::max(high, static_cast<double>(value));
    }
  }
};

ColourScale to_scale(const Quantity& quantity, const PictureRequest& request, const Extremes& found) {
  ColourScale scale{quantity.label, found.low, found.high, quantity.logarithmic};
  if (request.range) {
    scale.low = request.range->first;
    scale.high = request.range->second;
  } else if (!(found.low <= found.high)) {
    scale.low = quantity.logarithmic ? 1.0 : 0.0;  // no particles: any scale will do
    scale.high = 10.0;
  } else if (!(found.high > found.low)) {
    const double half = std::max(1e-6, 1e-3 * std::abs(found.low));  // all the same: in the middle of the scale
    scale.low -= half;
    scale.high += half;
  }
  if (scale.logarithmic && !(scale.low > 0.0)) scale.logarithmic = false;
  return scale;
}

SurfaceOverlay to_overlay(const std::string& name) {
  return name == "wire"          ? SurfaceOverlay::wire
         : name == "translucent" ? SurfaceOverlay::translucent
                                 : SurfaceOverlay::none;
}

}  // namespace

std::vector<int> choose_sheet_frames(const FrameRange& frames, int n) {
  const int count = std::min(n, frames.last - frames.first + 1);
  std::vector<int> chosen;
  for (int k = 0; k < count; ++k)
    chosen.push_back(count == 1
                         ? frames.first
                         : frames.first + static_cast<int>(std::lround(static_cast<double>(frames.last - frames.first) *
                                                                       k / (count - 1))));
  return chosen;
}

void diagnose_frames(const Scene& scene, const OutputFolder& folder, const FrameRange& frames,
                     const PictureRequest& request, Progress& progress) {
  const Quantity quantity = to_quantity(scene, request.colour_by);
  const SurfaceOverlay overlay = to_overlay(request.overlay);
  RenderScene view = build_view(scene);
  const Camera camera = view.camera;
  const auto colliders_at_rest = view.colliders;
  const bool has_bodies =
      std::any_of(scene.colliders.begin(), scene.colliders.end(), [](const ColliderSettings& c) { return c.rigid(); });
  create_directories_or_fail(folder.diagnostic(request.colour_by, 1).parent_path());

  std::vector<int> chosen;
  if (request.sheet_columns > 0)
    chosen = choose_sheet_frames(frames, request.sheet_columns * request.sheet_rows);
  else
    for (int frame = frames.first; frame <= frames.last; ++frame) chosen.push_back(frame);

  // One scale for all frames, else their colours would not compare.
  FailedFrames failed("render", scene.file, progress);
  Extremes found;
  std::vector<int> sound;
  for (const int frame : chosen) {
    if (request.range) {
      sound = chosen;
      break;
    }
    stop_if_asked(progress, "render", frame);
    failed.attempt(frame, [&] {
      found.extend(quantity.values(read_particles(folder.particles(frame))), quantity.logarithmic);
      sound.push_back(frame);
    });
  }
  const ColourScale scale = to_scale(quantity, request, found);

  for (const int frame : sound) {
    progress.update({"render", frame, frames.first, frames.last, 0.0, request.colour_by});
    stop_if_asked(progress, "render", frame);
    failed.attempt(frame, [&] {
      const double time = (frame - 1) / scene.shot.fps;
      const std::vector<BodyPose> bodies = has_bodies ? read_body_poses(folder.bodies(frame)) : std::vector<BodyPose>{};
      place_colliders(scene, time, bodies, colliders_at_rest, view);
      view.camera = camera_at(scene, camera, time);
      const ParticleFrame particles = read_particles(folder.particles(frame));
      const std::vector<float> values = quantity.values(particles);
      SurfaceMesh surface;
      if (overlay != SurfaceOverlay::none) surface = read_surface(folder.surface_obj(frame), folder.surface_vdb(frame));
      const std::string stamp =
          fmt::format("{}  frame {}  t = {:.3f} s  {} particles", scene.shot.name, frame, time, particles.size());
      // Half the spacing: neighbours touch.
      const DiagnosticPicture picture{particles.position, values, 0.5 * particles.spacing, scale, stamp,
                                      &surface,           overlay};
      write_png(folder.diagnostic(request.colour_by, frame), draw_diagnostic(picture, view));
    });
  }
  failed.throw_if_any();
}

std::filesystem::path write_sheet(const OutputFolder& folder, const FrameRange& frames, const PictureRequest& request) {
  std::vector<ImageRgb8> pictures;
  for (const int frame : choose_sheet_frames(frames, request.sheet_columns * request.sheet_rows))
    pictures.push_back(
        read_png(request.diagnostic ? folder.diagnostic(request.colour_by, frame) : folder.picture(frame)));
  const auto path = request.diagnostic ? folder.sheet(request.colour_by) : folder.sheet();
  write_png(path, make_contact_sheet(pictures, request.sheet_columns));
  return path;
}

}  // namespace smelt
