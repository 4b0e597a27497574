#include "core/sph/periodic.h"

#include "core/error.h"
#include "core/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace smelt {

template <int Dim>
void wrap_positions(const Box<Dim>& period, std::span<Vec<Dim>> position) {
  parallel_for_each(position.size(), [&](std::size_t i) {
    for (int a = 0; a < Dim; ++a) {
      if (!is_periodic(period, a)) continue;
      const double lower = period.lower[a], upper = period.upper[a];
      double& x = position[i][a];
      if (x >= lower && x < upper) continue;
      x -= (upper - lower) * std::floor((x - lower) / (upper - lower));
      // A hair below the lower face rounds up to the upper one, which is the lower one.
      if (x >= upper || x < lower) x = lower;
    }
  });
}

template <int Dim>
void check_period(const Box<Dim>& period, double reach) {
  for (int a = 0; a < Dim; ++a)
    if (is_periodic(period, a) && !(period.upper[a] - period.lower[a] >= 2.0 * reach))
      fail(
          "simulation: the periodic box is {:.6g} m long along {}; it must be at least {:.6g} m, twice the reach of a "
          "particle",
          period.upper[a] - period.lower[a], "xyz"[a], 2.0 * reach);
}

template <int Dim>
PeriodicImages<Dim> make_periodic_images(const Box<Dim>& period, double reach, std::span<const Vec<Dim>> position) {
  PeriodicImages<Dim> images;
  for (std::size_t i = 0; i < position.size(); ++i) {
    // Each axis doubles, at most, what the axes before it made: an edge has images of images, a corner theirs.
    std::array<Vec<Dim>, std::size_t{1} << Dim> shifts;
    shifts[0] = Vec<Dim>::Zero();
    std::size_t n = 1;
    for (int a = 0; a < Dim; ++a) {
      if (!is_periodic(period, a)) continue;
      const double length = period.upper[a] - period.lower[a];
      const bool near_lower = position[i][a] - period.lower[a] < reach,
                 near_upper = period.upper[a] - position[i][a] < reach;
      if (!near_lower && !near_upper) continue;
      for (std::size_t k = 0; k < n; ++k) {
        shifts[n + k] = shifts[k];
        shifts[n + k][a] = near_lower ? length : -length;
      }
      n *= 2;
    }
    for (std::size_t k = 1; k < n; ++k) {
      images.source.push_back(static_cast<std::int32_t>(i));
      images.shift.push_back(shifts[k]);
    }
  }
  return images;
}

template <int Dim>
PeriodicImages<Dim> build_periodic_neighbour_lists(const Box<Dim>& period, std::span<const Vec<Dim>> position,
                                                   std::span<const std::int32_t> id, double radius, int row_multiple,
                                                   NeighbourLists& lists) {
  const std::size_t n = position.size();
  PeriodicImages<Dim> images = make_periodic_images<Dim>(period, radius, position);
  std::vector<Vec<Dim>> all(position.begin(), position.end());
  // An image and its source lie a period apart, never in the same cell, so they may share an id.
  std::vector<std::int32_t> all_ids(id.begin(), id.end());
  for (std::size_t k = 0; k < images.size(); ++k) {
    all.push_back(position[images.source[k]] + images.shift[k]);
    all_ids.push_back(id[images.source[k]]);
  }

  const auto order = compute_cell_order<Dim>(all, all_ids, radius);
  std::vector<Vec<Dim>> sorted(all.size());
  std::vector<std::int32_t> sorted_from(all.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    sorted[k] = all[order[k]];
    sorted_from[order[k]] = static_cast<std::int32_t>(k);
  }
  build_neighbour_lists<Dim>(sorted, radius, radius, row_multiple, lists);
  std::vector<NeighbourLists::Place> places(n);
  for (std::size_t i = 0; i < n; ++i) places[i] = lists.places[static_cast<std::size_t>(sorted_from[i])];
  lists.places = std::move(places);
  lists.names.assign(order.begin(), order.end());
  return images;
}

#define SMELT_INSTANTIATE(Dim)                                                                                \
  template void check_period<Dim>(const Box<Dim>&, double);                                                   \
  template void wrap_positions<Dim>(const Box<Dim>&, std::span<Vec<Dim>>);                                    \
  template PeriodicImages<Dim> make_periodic_images<Dim>(const Box<Dim>&, double, std::span<const Vec<Dim>>); \
  template PeriodicImages<Dim> build_periodic_neighbour_lists<Dim>(                                           \
      const Box<Dim>&, std::span<const Vec<Dim>>, std::span<const std::int32_t>, double, int, NeighbourLists&);
SMELT_INSTANTIATE(1)
SMELT_INSTANTIATE(2)
SMELT_INSTANTIATE(3)
#undef SMELT_INSTANTIATE

}  // namespace smelt
