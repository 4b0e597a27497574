#include "core/error.h"
#include "io/atomic_file.h"
#include "io/png.h"
#include "io/surface_vdb.h"
#include "render/render_frame.h"
#include "scenes/build_view.h"
#include "scenes/stage_frames.h"
#include "scenes/stages.h"

#include <algorithm>

namespace smelt {

void render_frames(const Scene& scene, const OutputFolder& folder, const StageOptions& options, RunReport& report, Progress& progress) {
  RenderScene view = build_view(scene);
  const auto colliders_at_rest = view.colliders;
  const bool has_bodies =
      std::any_of(scene.colliders.begin(), scene.colliders.end(), [](const ColliderSettings& c) { return c.rigid(); });
  check_scene(view);
  create_directories_or_fail(folder.frames());
  RenderOptions quality;
  quality.samples = scene.render.samples;
  quality.denoise = scene.render.denoise;
  quality.seed = static_cast<std::uint32_t>(scene.render.seed);
  for (int frame = options.frames.first; frame <= options.frames.last; ++frame) {
    const auto picture = folder.picture(frame);
    progress.update({"render", frame, options.frames.first, options.frames.last, 0.0, ""});
    stop_if_asked(progress, "render", frame);
    if (options.resume && all_exist({picture})) continue;

    const CostMeter meter;
    const std::vector<BodyPose> bodies = has_bodies ? read_body_poses(folder.bodies(frame)) : std::vector<BodyPose>{};
    place_colliders(scene, (frame - 1) / scene.shot.fps, bodies, colliders_at_rest, view);
    const SurfaceMesh surface = read_surface(folder.surface_obj(frame), folder.surface_vdb(frame));
    try {
      write_png(picture, render_frame(surface, view, quality, frame));
    } catch (const Error& error) {
      fail("frame {}: {}", frame, error.what());
    }
    report.set_rendered(frame, meter.finish({picture}));
  }
}

}  // namespace smelt
