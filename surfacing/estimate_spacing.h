#pragma once
// The distance between particles of a file that does not say it.

#include "core/geometry/vec.h"

#include <span>

namespace smelt {

/// The spacing s [m] at which the fullest tenth of the particles fill space: c(s) = s^3 sum_j W(x_i - x_j, 2 s) is 1 in the bulk of a
/// fluid of particle volume s^3. Starts from the median distance to the nearest neighbour and iterates s <- s c^(-1/3). Within
/// 1 % on lattices, jittered or not, that are 8 particles thick; where nothing is thick (c < 0.6 at the start), which a sheet or a spray
/// is, the median distance itself. Throws Error for fewer than 8 particles, for particles that are not finite (names the first) and for
/// ones that are mostly at the same place.
double estimate_spacing(std::span<const Vec3> position);

}  // namespace smelt
