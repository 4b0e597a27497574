#pragma once
// Periodic boxes: what leaves through a face comes in through the opposite one, and particles near a face are seen
// across it.

#include "core/sph/neighbours.h"

#include <cstdint>
#include <span>
#include <vector>

namespace smelt {

/// Whether `period` repeats along an axis: where its upper end is above its lower one. A default (empty) box repeats
/// along none.
template <int Dim>
bool is_periodic(const Box<Dim>& period, int axis) {
  return period.upper[axis] > period.lower[axis];
}

/// Copies of particles that others see across a face: records n, n + 1, ... of the pair fields, after the n particles
/// themselves.
template <int Dim>
struct PeriodicImages {
  std::vector<std::int32_t> source;  ///< the particle that record n + k is a copy of
  std::vector<Vec<Dim>> shift;       ///< what its position differs by [m]

  std::size_t size() const { return source.size(); }
};

/// Moves what is outside the box back into it, [lower, upper) along each periodic axis; positions inside keep their
/// bits [m].
template <int Dim>
void wrap_positions(const Box<Dim>& period, std::span<Vec<Dim>> position);

/// Throws Error where the box is shorter than twice `reach` [m] along a periodic axis: a particle would see a neighbour
/// twice.
template <int Dim>
void check_period(const Box<Dim>& period, double reach);

/// The images within `reach` [m] of the box, in the order of their sources. `period` has passed check_period with this
/// reach, and `position` is wrapped.
template <int Dim>
PeriodicImages<Dim> make_periodic_images(const Box<Dim>& period, double reach, std::span<const Vec<Dim>> position);

/// The images of `position` and the rows of all pairs with |x_ij| < radius, image or not, rows in the order of the
/// particles. Indices from n on name images, which have no rows. Positions [m] must be wrapped; `id` settles the order
/// where cells leave it open.
template <int Dim>
PeriodicImages<Dim> build_periodic_neighbour_lists(const Box<Dim>& period, std::span<const Vec<Dim>> position,
                                                   std::span<const std::int32_t> id, double radius, int row_multiple,
                                                   NeighbourLists& lists);

}  // namespace smelt
