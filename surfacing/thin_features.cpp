#include "surfacing/thin_features.h"

#include "core/error.h"
#include "surfacing/local_particles.h"

#include <tbb/parallel_for.h>

#include <cmath>

namespace smelt {

std::vector<float> compute_filling(const ParticleBins& bins, std::span<const float> volume, double h) {
  CHECK_EQ(volume.size(), bins.position.size());
  std::vector<float> filling(volume.size());
  const auto scale = static_cast<float>(1.0 / (h * h * h));
  tbb::parallel_for(std::size_t{0}, bins.n_bins(), [&](std::size_t b) {
    Box3 box;
    for (std::uint32_t i = bins.begin[b]; i < bins.begin[b + 1]; ++i) box.extend(bins.position[i]);
    LocalParticles<0> near;
    gather_particles(near, bins, volume, box, h, [](std::uint32_t) { return std::array<float, 0>{}; });
    for (std::uint32_t i = bins.begin[b]; i < bins.begin[b + 1]; ++i)
      filling[i] = scale * sum_at(near, bins.position[i])[0];
  });
  return filling;
}

void strengthen_thin_features(std::span<float> volume, const ParticleBins& bins, std::span<const float> filling,
                              double h, double iso, double gain) {
  CHECK_EQ(filling.size(), volume.size());
  constexpr float full = 0.40f;
  const auto exponent = static_cast<float>(0.5 * gain);
  for (std::size_t j = 0; j < volume.size(); ++j)
    if (filling[j] < full) volume[j] *= std::pow(full / filling[j], exponent);

  const std::vector<float> chi = compute_filling(bins, volume, h);
  const auto least = static_cast<float>(1.3 * iso);
  for (std::size_t j = 0; j < volume.size(); ++j)
    if (chi[j] < least) volume[j] *= least / chi[j];
}

}  // namespace smelt
