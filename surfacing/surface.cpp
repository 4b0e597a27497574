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
  if (o.cell_over_spacing > 1.5 * o.kernel_over_spacing)
    fail(
        "surfacing: cell_over_spacing is {} and kernel_over_spacing {}: cells wider than one and a half kernels pass "
        "particles by; take smaller cells",
        o.cell_over_spacing, o.kernel_over_spacing);
  if (!(o.thin_feature_gain >= 0.0 && o.thin_feature_gain <= 2.0))
    fail("surfacing: thin_feature_gain is {}: it must lie between 0 and 2; 1 keeps the volume of drops",
         o.thin_feature_gain);
  if (o.smoothing_passes < 0) fail("surfacing: smoothing_passes is {}: it must not be negative", o.smoothing_passes);
}

void check_particles(const ParticleFrame& p) {
  if (p.size() == 0) fail("surfacing: frame {} has no particles: there is nothing to make a surface of", p.frame);
  if (!(p.spacing > 0.0) || !(p.mass > 0.0))
    fail("surfacing: frame {}: the particle spacing is {} m and the mass {} kg: both must be positive", p.frame,
         p.spacing, p.mass);
  CHECK_EQ(p.velocity.size(), p.size());
  const auto elsewhere = [&](const Vec3& x) { return x != p.position.front(); };
  if (p.size() > 1 && std::none_of(p.position.begin(), p.position.end(), elsewhere))
    fail(
        "surfacing: frame {}: all {} particles are at one place, ({}, {}, {}) m: no fluid is like that; is the file "
        "whole?",
        p.frame, p.size(), p.position[0][0], p.position[0][1], p.position[0][2]);
  CHECK_EQ(p.density.size(), p.size());
  for (std::size_t i = 0; i < p.size(); ++i)
    if (!(p.density[i] > 0.0f && std::isfinite(p.density[i])))
      fail("surfacing: frame {}: particle {} has the density {} kg/m3: it must be positive", p.frame, i, p.density[i]);
}

std::vector<float> sorted_volumes(const ParticleFrame& particles, const ParticleBins& bins) {
  std::vector<float> volume(particles.size());
  parallel_for_each(volume.size(), [&](std::size_t j) {
    const std::size_t i = bins.index[j];
    volume[j] = static_cast<float>(particles.mass_of(i) / particles.density[i]);
  });
  return volume;
}

}  // namespace

SurfaceMesh build_surface(const ParticleFrame& particles, const SurfacingOptions& options) {
  check_options(options);
  check_particles(particles);
  const double spacing = particles.spacing, h = options.kernel_over_spacing * spacing;
  const ParticleBins bins = sort_into_bins(particles.position, 2.0 * h);
  std::vector<float> volume = sorted_volumes(particles, bins);

  const SurfaceRegion region = find_surface_region(bins, volume, spacing);
  const std::vector<float> filling = compute_filling(bins, volume, 2.0 * spacing, &region);
  if (options.thin_feature_gain > 0.0)
    strengthen_thin_features(
        volume, bins, filling,
        {spacing, h, options.cell_over_spacing * spacing, options.iso_value, options.thin_feature_gain});

  const auto iso = static_cast<float>(options.iso_value);
  KernelShapes shapes;
  if (options.anisotropic) shapes = compute_kernel_shapes(bins, region, spacing, h);
  const SparseField chi = compute_chi({bins, volume, h, options.anisotropic ? &shapes : nullptr},
                                      options.cell_over_spacing * spacing, iso, options.memory_limit_bytes, &region);

  SurfaceMesh surface;
  surface.mesh = extract_iso_surface(chi, iso);
  if (surface.mesh.triangles.empty())
    fail(
        "surfacing: frame {}: chi stays below the iso-value {} everywhere: take a lower iso_value, finer cells or a "
        "narrower kernel",
        particles.frame, options.iso_value);
  std::vector<float> strength = compute_attributes(surface, particles, bins, volume, filling, h);
  for (float& s : strength) s = smoothing_strength(s);
  const VertexNeighbours near = find_vertex_neighbours(surface.mesh);
  smooth_mesh(surface.mesh, near, strength, options.smoothing_passes);
  surface.normals = compute_vertex_normals(surface.mesh, near);
  return surface;
}

}  // namespace smelt
