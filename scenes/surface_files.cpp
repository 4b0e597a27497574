#include "scenes/surface_files.h"

#include "core/error.h"
#include "io/obj.h"
#include "io/ply.h"
#include "io/surface_vdb.h"
#include "surfacing/surface.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <sys/resource.h>

namespace smelt {

namespace {

/// What this process may still take [bytes]: the machine's free memory as Linux estimates it, or `ulimit -v` where that
/// is less; without either, no limit.
double available_memory() {
  double bytes = std::numeric_limits<double>::infinity();
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) bytes = static_cast<double>(limit.rlim_cur);
  std::ifstream info("/proc/meminfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("MemAvailable:")) return std::min(bytes, 1024.0 * std::stod(line.substr(13)));
  return bytes;
}

/// Blue, white, red over [low, high].
std::vector<Vec3f> temperature_colours(const std::vector<float>& temperature, const SurfaceOutputs& outputs) {
  std::vector<Vec3f> colours;
  const double range = outputs.colour_hot - outputs.colour_cold;
  for (const float kelvin : temperature) {
    const auto t =
        static_cast<float>(std::clamp((static_cast<double>(kelvin) - outputs.colour_cold) / range, 0.0, 1.0));
    colours.emplace_back(std::min(1.0f, 2.0f * t), 1.0f - std::abs(2.0f * t - 1.0f), std::min(1.0f, 2.0f - 2.0f * t));
  }
  return colours;
}

}  // namespace

std::vector<std::filesystem::path> surface_files(const OutputFolder& folder, int frame, const SurfaceOutputs& outputs) {
  std::vector<std::filesystem::path> files = {folder.surface_vdb(frame)};
  if (outputs.ply) files.push_back(folder.surface_ply(frame));
  files.push_back(folder.surface_obj(frame));
  return files;
}

SurfaceMesh make_surface_files(const std::filesystem::path& source, const ParticleFrame& particles,
                               const Scene& settings, const OutputFolder& folder, int frame) {
  const SurfaceOutputs& outputs = settings.surface_outputs;
  SurfacingOptions options = settings.surface;
  options.memory_limit_bytes = available_memory();
  SurfaceMesh surface;
  try {
    if (outputs.vertex_colours && particles.size() > 0 && particles.temperature.empty())
      fail("the particles have no temperature to make surface.vertex_colours from");
    if (outputs.vertex_colours && !(outputs.colour_hot > outputs.colour_cold))
      fail("surface.colour_hot_K = {} must be above surface.colour_cold_K = {}", outputs.colour_hot,
           outputs.colour_cold);
    if (particles.size() > 0) surface = build_surface(particles, options);
  } catch (const Error& error) {
    fail("{}: {}", source.string(), error.what());
  }
  write_surface_vdb(folder.surface_vdb(frame), surface, options.cell_over_spacing * particles.spacing, frame,
                    particles.time, outputs.fog_volume);
  if (outputs.ply) write_ply(folder.surface_ply(frame), surface);
  const std::vector<Vec3f> colours =
      outputs.vertex_colours ? temperature_colours(surface.temperature, outputs) : std::vector<Vec3f>();
  write_obj(folder.surface_obj(frame), surface, colours);
  return surface;
}

void EmptySurfaces::look_at(int frame, const ParticleFrame& particles, const SurfaceMesh& surface) {
  if (particles.size() == 0 || !surface.mesh.triangles.empty() || ++n_empty_ > 3) return;
  progress_.message(fmt::format(
      "warning: frame {}: its {} particles have no surface: chi stays below surface.iso_value = {} everywhere; {}",
      frame, particles.size(), options_.iso_value,
      options_.thin_feature_gain > 0.0 ? "a lower one would show them"
                                       : "surface.thin_feature_gain = 0 lets drops and threads go, 1 keeps them"));
}

void EmptySurfaces::tell_how_many() const {
  if (n_empty_ > 3) progress_.message(fmt::format("warning: {} frames have particles and no surface", n_empty_));
}

}  // namespace smelt
