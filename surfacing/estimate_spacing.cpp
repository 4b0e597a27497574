#include "surfacing/estimate_spacing.h"

#include "core/error.h"
#include "core/parallel.h"
#include "surfacing/particle_bins.h"
#include "surfacing/thin_features.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

namespace smelt {

namespace {

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Points sorted so that the middle one of any range that halving [0, n) leads to parts the others along one axis.
class PointTree {
 public:
  explicit PointTree(std::span<const Vec3> point) : point_(point), order_(point.size()), axis_(point.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    sort(0, order_.size());
  }

  /// From point i to the nearest other one; 0 where one is at the same place.
  double nearest_distance(std::uint32_t i) const {
    double squared = std::numeric_limits<double>::infinity();
    search(i, 0, order_.size(), squared);
    return std::sqrt(squared);
  }

 private:
  void sort(std::size_t begin, std::size_t end) {
    if (end - begin < 2) return;
    Box3 box;
    for (std::size_t n = begin; n < end; ++n) box.extend(point_[order_[n]]);
    int axis = 0;
    box.extent().maxCoeff(&axis);
    const std::size_t middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + static_cast<std::ptrdiff_t>(begin),
                     order_.begin() + static_cast<std::ptrdiff_t>(middle),
                     order_.begin() + static_cast<std::ptrdiff_t>(end),
                     [&](std::uint32_t a, std::uint32_t b) { return point_[a][axis] < point_[b][axis]; });
    axis_[middle] = static_cast<std::uint8_t>(axis);
    if (end - begin < 4096) {
      sort(begin, middle);
      sort(middle + 1, end);
    } else {
      tbb::parallel_invoke([&] { sort(begin, middle); }, [&] { sort(middle + 1, end); });
    }
  }

  void search(std::uint32_t i, std::size_t begin, std::size_t end, double& squared) const {
    if (begin == end) return;
    const std::size_t middle = begin + (end - begin) / 2;
    const Vec3& x = point_[i];
    const Vec3& here = point_[order_[middle]];
    if (order_[middle] != i) squared = std::min(squared, (here - x).squaredNorm());
    const double beyond = x[axis_[middle]] - here[axis_[middle]];
    if (beyond < 0.0) search(i, begin, middle, squared);
    if (beyond >= 0.0 || beyond * beyond < squared) search(i, middle + 1, end, squared);
    if (beyond >= 0.0 && beyond * beyond < squared) search(i, begin, middle, squared);
  }

  std::span<const Vec3> point_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint8_t> axis_;
};

double median_nearest_distance(std::span<const Vec3> position) {
  const PointTree tree(position);
  std::vector<double> nearest(position.size());
  parallel_for_each(nearest.size(),
                    [&](std::size_t i) { nearest[i] = tree.nearest_distance(static_cast<std::uint32_t>(i)); });
  return quantile(std::move(nearest), 0.5);
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
      fail("particle {} of the file, counted from 0, is at ({}, {}, {}): positions must be finite", i, position[i][0],
           position[i][1], position[i][2]);
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
