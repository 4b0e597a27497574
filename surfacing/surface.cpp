#include "surfacing/surface.h"

#include "core/error.h"
#include "core/parallel.h"
#include "surfacing/attributes.h"
#include "surfacing/marching_cubes.h"
#include "surfacing/particle_bins.h"
#include "surfacing/smooth_mesh.h"
#include "surfacing/sparse_field.h"
#include "surfacing/surface_region.h"
#include "surfacing/thin_features.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace smelt {

namespace {

void check_options(const SurfacingOptions& o) {
  if (!(o.iso_value > 0.0 && o.iso_value < 1.0))
    fail("surfacing: iso_value is {}: it must lie between 0 and 1, both excluded; 0.5 keeps flat surfaces in place",
         o.iso_value);
  if (!(o.cell_over_spacing > 0.0 && o.cell_over_spacing <= 4.0))
    fail("surfacing: cell_over_spacing is {}: it must be positive and at most 4; 0.5 is usual", o.cell_over_spacing);
  if (!(o.kernel_over_spacing >= 0.5 && o.kernel_over_spacing <= 4.0))
    fail(
        "surfacing: kernel_over_spacing is {}: it must lie between 0.5, below which particles do not meet, and 4; 1 is "
        "usual",
        o.kernel_over_spacing);
  if (o.cell_over_spacing > most_cell_over_kernel * o.kernel_over_spacing)
    fail(
        "surfacing: cell_over_spacing is {} and kernel_over_spacing {}: cells wider than {} kernels pass particles by; "
        "take smaller cells",
        o.cell_over_spacing, o.kernel_over_spacing, most_cell_over_kernel);
  if (!(o.thin_feature_gain >= 0.0 && o.thin_feature_gain <= 2.0))
    fail("surfacing: thin_feature_gain is {}: it must lie between 0 and 2; 1 keeps the volume of drops",
         o.thin_feature_gain);
  if (o.smoothing_passes < 0) fail("surfacing: smoothing_passes is {}: it must not be negative", o.smoothing_passes);
}

/// The first i in [0, n) that is not good, or n.
template <typename Good>
std::size_t find_bad(std::size_t n, Good&& good) {
  return deterministic_reduce_blocks(
      n, n,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          if (!good(i)) return i;
        return n;
      },
      [](std::size_t a, std::size_t b) { return std::min(a, b); });
}

/// Names the particle and the field; `must` says what its values are to be.
template <typename Value, typename Good>
void check_field(const ParticleFrame& p, const char* name, const std::vector<Value>& field, const char* unit,
                 const char* must, Good&& good) {
  if (field.empty()) return;
  CHECK_EQ(field.size(), p.size());
  const std::size_t i = find_bad(field.size(), [&](std::size_t n) { return good(field[n]); });
  if (i == field.size()) return;
  std::string value;
  if constexpr (std::is_same_v<Value, float>)
    value = fmt::format("{}", field[i]);
  else
    value = fmt::format("({}, {}, {})", field[i][0], field[i][1], field[i][2]);
  fail(
      "surfacing: frame {}: particle {} has the {} {} {}: it must be {}; the simulation diverged or the file is "
      "damaged",
      p.frame, p.id.empty() ? static_cast<std::int64_t>(i) : p.id[i], name, value, unit, must);
}

void check_positions(const ParticleFrame& p, double bin_edge) {
  const auto finite = [](const auto& x) { return x.allFinite(); };
  check_field(p, "position", p.position, "m", "finite", finite);
  const double farthest = lattice_limit * bin_edge;
  const std::size_t i =
      find_bad(p.size(), [&](std::size_t n) { return p.position[n].cwiseAbs().maxCoeff() < farthest; });
  if (i < p.size())
    fail(
        "surfacing: frame {}: particle {} is at ({}, {}, {}) m: with this particle spacing nothing farther than {:.3g} "
        "m from the origin can be gridded; move the scene to the origin, or take out what strays (an [[outflow]] does "
        "while the scene is simulated)",
        p.frame, p.id.empty() ? static_cast<std::int64_t>(i) : p.id[i], p.position[i][0], p.position[i][1],
        p.position[i][2], farthest);
  const auto elsewhere = [&](const Vec3& x) { return x != p.position.front(); };
  if (p.size() > 1 && std::none_of(p.position.begin(), p.position.end(), elsewhere))
    fail(
        "surfacing: frame {}: all {} particles are at one place, ({}, {}, {}) m: no fluid is like that; is the file "
        "whole?",
        p.frame, p.size(), p.position[0][0], p.position[0][1], p.position[0][2]);
}

void check_particles(const ParticleFrame& p, double kernel_over_spacing) {
  if (p.size() == 0) fail("surfacing: frame {} has no particles: there is nothing to make a surface of", p.frame);
  const auto positive = [](auto x) { return x > 0 && std::isfinite(x); };
  if (!positive(p.spacing) || !positive(p.mass))
    fail(
        "surfacing: frame {}: the particle spacing is {} m and the mass {} kg: both must be positive; is the file "
        "whole?",
        p.frame, p.spacing, p.mass);
  CHECK_EQ(p.velocity.size(), p.size());
  CHECK_EQ(p.density.size(), p.size());
  if (!p.id.empty()) CHECK_EQ(p.id.size(), p.size());
  check_positions(p, 2.0 * kernel_over_spacing * p.spacing);
  const auto finite = [](float x) { return std::isfinite(x); };
  const auto all_finite = [](const Vec3f& x) { return x.allFinite(); };
  check_field(p, "density", p.density, "kg/m3", "positive", positive);
  check_field(p, "mass", p.masses, "kg", "positive", positive);
  check_field(p, "velocity", p.velocity, "m/s", "finite", all_finite);
  check_field(p, "temperature", p.temperature, "K", "finite", finite);
  check_field(p, "viscosity", p.viscosity, "Pa s", "finite", finite);
  check_field(p, "rest position", p.rest, "m", "finite", all_finite);
}

std::vector<float> sorted_volumes(const ParticleFrame& particles, const ParticleBins& bins) {
  std::vector<float> volume(particles.size());
  parallel_for_each(volume.size(), [&](std::size_t j) {
    const std::size_t i = bins.index[j];
    volume[j] = static_cast<float>(particles.mass_of(i) / particles.density[i]);
  });
  return volume;
}

/// Chi and the shapes of its kernels are gone when the mesh is there.
TriangleMesh extract_surface(const ParticleBins& bins, std::span<const float> volume, const SurfaceRegion& region,
                             double spacing, const SurfacingOptions& options) {
  const double h = options.kernel_over_spacing * spacing;
  const auto iso = static_cast<float>(options.iso_value);
  KernelShapes shapes;
  if (options.anisotropic) shapes = compute_kernel_shapes(bins, region, spacing, h);
  const SparseField chi = compute_chi({bins, volume, h, options.anisotropic ? &shapes : nullptr},
                                      options.cell_over_spacing * spacing, iso, options.memory_limit_bytes, &region);
  return extract_iso_surface(chi, iso);
}

}  // namespace

SurfaceMesh build_surface(const ParticleFrame& particles, const SurfacingOptions& options) {
  check_options(options);
  check_particles(particles, options.kernel_over_spacing);
  const double spacing = particles.spacing, h = options.kernel_over_spacing * spacing;
  const ParticleBins bins = sort_into_bins(particles.position, 2.0 * h);
  std::vector<float> volume = sorted_volumes(particles, bins);

  const SurfaceRegion region = find_surface_region(bins, volume, spacing);
  const std::vector<float> filling = compute_filling(bins, volume, 2.0 * spacing, &region);
  if (options.thin_feature_gain > 0.0)
    strengthen_thin_features(
        volume, bins, filling,
        {spacing, h, options.cell_over_spacing * spacing, options.iso_value, options.thin_feature_gain});

  SurfaceMesh surface;
  surface.mesh = extract_surface(bins, volume, region, spacing, options);
  if (surface.mesh.triangles.empty()) return surface;
  std::vector<float> strength = compute_attributes(surface, particles, bins, volume, filling, h);
  for (float& s : strength) s = smoothing_strength(s);
  const VertexNeighbours near = find_vertex_neighbours(surface.mesh);
  smooth_mesh(surface.mesh, near, strength, options.smoothing_passes);
  surface.normals = compute_vertex_normals(surface.mesh, near);
  return surface;
}

}  // namespace smelt
