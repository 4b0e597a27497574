#include "core/error.h"
#include "core/hash.h"
#include "io/atomic_file.h"
#include "io/exr.h"
#include "io/png.h"
#include "io/surface_vdb.h"
#include "render/render_frame.h"
#include "scenes/build_view.h"
#include "scenes/failed_frames.h"
#include "scenes/scene_writer.h"
#include "scenes/stage_frames.h"
#include "scenes/stages.h"

#include <algorithm>

namespace smelt {

namespace {

bool is_done(const Scene& scene, const OutputFolder& folder, int frame) {
  return all_exist({folder.picture(frame)}) && (!scene.render.exr || all_exist({folder.exr(frame)}));
}

/// All that pictures depend on beside the surface and where colliders are.
std::string describe_look(const Scene& scene) {
  std::string text = write_section(scene, SceneSection::render);
  for (const ColliderSettings& c : scene.colliders)
    text += fmt::format("{} {} {} {} {}\n", c.colour[0], c.colour[1], c.colour[2], c.material, c.roughness);
  return text;
}

/// Writes the files of a picture and returns them. The PNG last: where it is, the frame is whole.
std::vector<std::filesystem::path> write_pictures(const Scene& scene, const OutputFolder& folder, int frame,
                                                  const Film& film, const Vec3& eye) {
  const ToneCurve curve = scene.look.tone_curve.value_or(scene.look.material == "lava" ? "film" : "neutral") == "film"
                              ? ToneCurve::film
                              : ToneCurve::neutral;
  if (scene.render.exr) write_exr(folder.exr(frame), to_layers(film, eye));
  if (scene.render.png_bits == 16)
    write_png(folder.picture(frame), develop16(film, scene.look.exposure, curve));
  else
    write_png(folder.picture(frame), develop8(film, scene.look.exposure, curve));
  if (scene.render.exr) return {folder.picture(frame), folder.exr(frame)};
  return {folder.picture(frame)};
}

}  // namespace

void render_frames(const Scene& scene, const OutputFolder& folder, const StageOptions& options, RunReport& report,
                   Progress& progress) {
  RenderScene view = build_view(scene);
  const Camera camera = view.camera;
  const auto colliders_at_rest = view.colliders;
  const bool has_bodies =
      std::any_of(scene.colliders.begin(), scene.colliders.end(), [](const ColliderSettings& c) { return c.rigid(); });
  create_directories_or_fail(folder.frames());
  const RenderOptions quality = to_options(scene.render);
  const std::string look = describe_look(scene);
  FailedFrames failed("render", scene.file, progress);
  for (int frame = options.frames.first; frame <= options.frames.last; ++frame) {
    progress.update({"render", frame, options.frames.first, options.frames.last, 0.0, ""});
    stop_if_asked(progress, "render", frame);
    const std::uint64_t settings = hash_bytes(look, report.settings_of(frame, "surface").value_or(0));
    if (options.resume && report.settings_of(frame, "render") == settings && is_done(scene, folder, frame)) continue;
    failed.attempt(frame, [&] {
      report.begin(frame, "render");
      const CostMeter meter;
      const double time = (frame - 1) / scene.shot.fps;
      const std::vector<BodyPose> bodies = has_bodies ? read_body_poses(folder.bodies(frame)) : std::vector<BodyPose>{};
      place_colliders(scene, time, bodies, colliders_at_rest, view);
      view.camera = camera_at(scene, camera, time);
      const SurfaceMesh surface = read_surface(folder.surface_obj(frame), folder.surface_vdb(frame));
      const Film film = render_film(surface, view, quality, frame);
      const auto files = write_pictures(scene, folder, frame, film, view.camera.eye);
      report.set_rendered(frame, clamped_share(film), meter.finish(files), settings);
    });
  }
  failed.throw_if_any();
}

}  // namespace smelt
