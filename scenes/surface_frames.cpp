#include "core/hash.h"
#include "io/atomic_file.h"
#include "io/particles_vdb.h"
#include "scenes/failed_frames.h"
#include "scenes/scene_writer.h"
#include "scenes/stage_frames.h"
#include "scenes/stages.h"
#include "scenes/surface_files.h"

namespace smelt {

void surface_frames(const Scene& scene, const OutputFolder& folder, const StageOptions& options, RunReport& report,
                    Progress& progress) {
  create_directories_or_fail(folder.surfaces());
  const std::uint64_t settings = hash_bytes(write_section(scene, SceneSection::surface));
  FailedFrames failed("surface", scene.file, progress);
  EmptySurfaces empty(scene.surface, progress);
  for (int frame = options.frames.first; frame <= options.frames.last; ++frame) {
    const auto files = surface_files(folder, frame, scene.surface_outputs);
    progress.update({"surface", frame, options.frames.first, options.frames.last, 0.0, ""});
    stop_if_asked(progress, "surface", frame);
    if (options.resume && report.settings_of(frame, "surface") == settings && all_exist(files)) continue;

    failed.attempt(frame, [&] {
      report.begin(frame, "surface");
      const CostMeter meter;
      const ParticleFrame particles = read_particles(folder.particles(frame));  // none before a vent opens
      const SurfaceMesh surface = make_surface_files(folder.particles(frame), particles, scene, folder, frame);
      empty.look_at(frame, particles, surface);
      report.set_surfaced(frame, compute_volume(surface.mesh), surface.mesh.vertices.size(),
                          surface.mesh.triangles.size(), meter.finish(files), settings);
    });
  }
  empty.tell_how_many();
  failed.throw_if_any();
}

}  // namespace smelt
