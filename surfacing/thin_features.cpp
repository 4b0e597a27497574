#include "surfacing/thin_features.h"

#include "core/error.h"
#include "core/parallel.h"
#include "surfacing/local_particles.h"

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

/// h^3 W sums at the particles of one bin.
template <typename Visit>
void sum_at_particles(LocalParticles<0>& near, const ParticleBins& bins, std::span<const float> volume, std::size_t bin,
                      double h, Visit&& visit) {
  gather_particles(near, bins, volume, bins.box(bin), h, [](std::uint32_t) { return std::array<float, 0>{}; });
  const auto scale = static_cast<float>(1.0 / (h * h * h));
  for (std::uint32_t j = bins.begin[bin]; j < bins.begin[bin + 1]; ++j)
    visit(j, scale * sum_at(near, bins.position(bin, j))[0]);
}

/// Calls body(near, bin) for all bins that `wanted` says yes to, with scratch of each task's own.
template <typename Wanted, typename Body>
void for_bins(const ParticleBins& bins, Wanted&& wanted, Body&& body) {
  parallel_blocks(
      bins.n_bins(),
      [&](std::size_t begin, std::size_t end) {
        LocalParticles<0> near;
        for (std::size_t b = begin; b < end; ++b)
          if (wanted(b)) body(near, b);
      },
      64);
}

constexpr float thin = 0.40f, full = 0.60f;  // fillings of what is strengthened, and of what is not

/// Of chi at a particle of the given filling, iso_j of the header.
float least_chi(float filling, const ThinFeatureSettings& s) {
  const double half_diagonal = 0.87 * s.cell;
  const double radius =
      std::max(std::min(0.445 * s.h, 0.62 * s.spacing), (1.0 - smoothing_strength(filling)) * half_diagonal);
  return static_cast<float>(s.iso) * cubic_spline(0.0f) / cubic_spline(static_cast<float>(radius / s.h));
}

}  // namespace

std::vector<float> compute_filling(const ParticleBins& bins, std::span<const float> volume, double h,
                                   const SurfaceRegion* region) {
  CHECK_EQ(volume.size(), bins.n_particles());
  std::vector<float> filling(volume.size(), 1.0f);
  const auto wanted = [&](std::size_t b) {
    if (!region) return true;
    const Box3 box = bins.box(b);
    const double far = filling_reach * region->node;
    return region->touches_surface({box.lower.array() - far, box.upper.array() + far});
  };
  for_bins(bins, wanted, [&](LocalParticles<0>& near, std::size_t b) {
    sum_at_particles(near, bins, volume, b, h, [&](std::uint32_t j, float sum) { filling[j] = sum; });
  });
  return filling;
}

void strengthen_thin_features(std::span<float> volume, const ParticleBins& bins, std::span<const float> filling,
                              const ThinFeatureSettings& settings) {
  CHECK_EQ(filling.size(), volume.size());
  const auto exponent = static_cast<float>(0.5 * settings.gain);
  for (std::size_t j = 0; j < volume.size(); ++j)
    if (filling[j] < thin) volume[j] *= std::pow(thin / filling[j], exponent);

  // All sums first, then all changes: the order of bins must not matter.
  const auto may_be_weak = [&](std::size_t b) {
    return std::any_of(filling.begin() + bins.begin[b], filling.begin() + bins.begin[b + 1],
                       [](float c) { return c < full; });
  };
  std::vector<float> factor(volume.size(), 1.0f);
  for_bins(bins, may_be_weak, [&](LocalParticles<0>& near, std::size_t b) {
    sum_at_particles(near, bins, volume, b, settings.h, [&](std::uint32_t j, float chi) {
      if (filling[j] >= full) return;
      if (const float least = least_chi(filling[j], settings); chi < least)
        factor[j] = std::pow(least / chi, std::min(1.0f, (full - filling[j]) / (full - thin)));
    });
  });
  for (std::size_t j = 0; j < volume.size(); ++j) volume[j] *= factor[j];
}

}  // namespace smelt
