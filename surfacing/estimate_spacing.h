#pragma once
// The distance between particles of a file that does not say it.

#include "core/geometry/vec.h"

#include <span>

namespace smelt {

/// The spacing s [m] at which the fullest tenth of the particles fill space: c(s) = s^3 sum_j W(x_i - x_j, 2 s) is 1 in
/// the bulk of a fluid of particle volume s^3. Starts from the median distance to the nearest neighbour, which costs n
/// log n wherever the particles are, and iterates s <- s c^(-1/3). Within 2 % on bodies 8 particles thick; of sheets
/// and sprays, in which twice as wide a kernel finds less, the median distance itself. Throws Error for fewer than 8
/// particles, for particles that are not finite (names the first) and for ones that are mostly at the same place.
double estimate_spacing(std::span<const Vec3> position);

}  // namespace smelt
