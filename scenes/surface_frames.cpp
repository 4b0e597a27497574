#include "core/error.h"
#include "io/atomic_file.h"
#include "io/obj.h"
#include "io/particles_vdb.h"
#include "io/surface_vdb.h"
#include "scenes/stage_frames.h"
#include "scenes/stages.h"
#include "surfacing/surface.h"

namespace smelt {

void surface_frames(const Scene& scene, const OutputFolder& folder, const StageOptions& options, RunReport& report, Progress& progress) {
  create_directories_or_fail(folder.surfaces());
  for (int frame = options.frames.first; frame <= options.frames.last; ++frame) {
    const auto obj = folder.surface_obj(frame), vdb = folder.surface_vdb(frame);
    progress.update({"surface", frame, options.frames.first, options.frames.last, 0.0, ""});
    stop_if_asked(progress, "surface", frame);
    if (options.resume && all_exist({obj, vdb})) continue;

    const CostMeter meter;
    const ParticleFrame particles = read_particles(folder.particles(frame));
    SurfaceMesh surface;
    try {
      if (particles.size() > 0) surface = build_surface(particles, scene.surface);  // before a vent opens there is nothing
    } catch (const Error& error) {
      fail("{}: {}", folder.particles(frame).string(), error.what());
    }
    // The OBJ last: where it is, the frame is whole.
    write_surface_vdb(vdb, surface, scene.surface.cell_over_spacing * particles.spacing, frame, particles.time);
    write_obj(obj, surface);
    report.set_surfaced(frame, compute_volume(surface.mesh), surface.mesh.vertices.size(), surface.mesh.triangles.size(),
                        meter.finish({obj, vdb}));
  }
}

}  // namespace smelt
