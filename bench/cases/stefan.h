#pragma once
// A melting front: a solid at its melting point on a hot wall, one phase, against Neumann's similarity solution.

#include "bench/cases/case.h"

namespace smelt::stefan {

/// A column 1 m high, melting from below. The error is the largest of the front's height relative to the exact one over
/// the reference's times with a front from a quarter to `farthest` of the column; the profile is the front [m] over
/// time [s].
Measurement measure_front(double spacing, double stefan_number, double jitter, double farthest);

/// As far up as the top has not felt the melting yet: a share of the column.
double farthest_front(double stefan_number);

Case make_case();

}  // namespace smelt::stefan
