#pragma once
// From the particles of a frame to the files of its surface.

#include "core/geometry/surface_mesh.h"
#include "core/sph/particle_frame.h"
#include "scenes/output_folder.h"
#include "scenes/progress.h"
#include "scenes/scene.h"

#include <filesystem>
#include <vector>

namespace smelt {

/// The files of a frame's surface; the OBJ last: where it is, the frame is whole.
std::vector<std::filesystem::path> surface_files(const OutputFolder& folder, int frame, const SurfaceOutputs& outputs);

/// Builds the surface of `particles`, read from `source`, and writes its files. No particles make an empty surface,
/// and so do some that settings are not made for (EmptySurfaces). Errors name `source` and, where one is at fault, the
/// particle; a grid that does not fit into what memory is free is refused before it is made.
SurfaceMesh make_surface_files(const std::filesystem::path& source, const ParticleFrame& particles,
                               const Scene& settings, const OutputFolder& folder, int frame);

/// Tells the user of frames whose particles have no surface: of the first three, then how many there were.
class EmptySurfaces {
 public:
  EmptySurfaces(const SurfacingOptions& options, Progress& progress) : options_(options), progress_(progress) {}

  void look_at(int frame, const ParticleFrame& particles, const SurfaceMesh& surface);
  void tell_how_many() const;

 private:
  SurfacingOptions options_;
  Progress& progress_;
  int n_empty_ = 0;
};

}  // namespace smelt
