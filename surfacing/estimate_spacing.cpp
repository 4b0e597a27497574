#include "surfacing/estimate_spacing.h"

#include "core/error.h"
#include "surfacing/particle_bins.h"
#include "surfacing/thin_features.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace smelt {

namespace {

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Distance from every particle to its nearest neighbour, or twice the bins' edge where none is in the bins around it.
std::vector<double> nearest_distances(const ParticleBins& bins) {
  std::vector<double> nearest(bins.n_particles(), 2.0 * bins.edge);
  for (std::size_t b = 0; b < bins.n_bins(); ++b)
    for (std::uint32_t i = bins.begin[b]; i < bins.begin[b + 1]; ++i) {
      const Vec3 x = bins.position(b, i);
      for_each_bin(bins, x.array() - bins.edge, x.array() + bins.edge, [&](std::size_t other) {
        for (std::uint32_t j = bins.begin[other]; j < bins.begin[other + 1]; ++j)
          if (j != i) nearest[i] = std::min(nearest[i], (bins.position(other, j) - x).norm());
      });
    }
  return nearest;
}

double median_nearest_distance(std::span<const Vec3> position) {
  Box3 box;
  for (const Vec3& x : position) box.extend(x);
  const double size = box.extent().maxCoeff();
  // From bins with a particle each, were the box full, to ones large enough for most to have a neighbour.
  double edge = size / std::cbrt(static_cast<double>(position.size()));
  for (; edge > 0.0 && edge <= 2.0 * size; edge *= 2.0)
    if (const double median = quantile(nearest_distances(sort_into_bins(position, edge)), 0.5); median <= edge)
      return median;
  return 0.0;
}

/// What the fullest tenth of the particles have around them, s^3 sum_j W(x_i - x_j, width s), at least.
double fullest_filling(std::span<const Vec3> position, double spacing, double width) {
  const ParticleBins bins = sort_into_bins(position, 2.0 * spacing);
  const std::vector<float> volume(position.size(), static_cast<float>(spacing * spacing * spacing));
  const std::vector<float> filling = compute_filling(bins, volume, width * spacing);
  return quantile(std::vector<double>(filling.begin(), filling.end()), 0.9);
}

}  // namespace

double estimate_spacing(std::span<const Vec3> position) {
  for (std::size_t i = 0; i < position.size(); ++i)
    if (!position[i].allFinite())
      fail("particle {} is at ({}, {}, {}): positions must be finite", i, position[i][0], position[i][1],
           position[i][2]);
  if (position.size() < 8)
    fail("{} particle{} too few to tell how far apart particles are; give --spacing_m", position.size(),
         position.size() == 1 ? " is" : "s are");
  double spacing = median_nearest_distance(position);
  if (!(spacing > 0.0))
    fail("most particles are at the same place as another, at ({}, {}, {}) m the first; is the file whole?",
         position[0][0], position[0][1], position[0][2]);
  // Twice as wide a kernel finds as much in a body, half as much in a sheet.
  if (fullest_filling(position, spacing, 3.0) < 0.7 * fullest_filling(position, spacing, 1.5)) return spacing;
  for (int round = 0; round < 20; ++round) {
    const double next = spacing / std::cbrt(fullest_filling(position, spacing, 2.0));
    if (std::abs(next / spacing - 1.0) < 1e-4) return next;
    spacing = next;
  }
  return spacing;
}

}  // namespace smelt
