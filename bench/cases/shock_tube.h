#pragma once
// The shock tube of [S 4.5.1], table 5: density by summation, energy equation, artificial viscosity, against the exact
// Riemann solution.

#include "bench/cases/case.h"

#include <vector>

namespace smelt::shock_tube {

/// State of the gas at a place. Units as in the reference file.
struct Point {
  double x = 0.0, density = 0.0, velocity = 0.0, pressure = 0.0;
};

/// [S]'s tube: particles of equal mass, `refinement` times as fine as its 400, h twice the wider spacing. The tube has
/// a mirror image behind its left end and repeats, so that it has no ends whose waves would have to be cut off:
/// membranes at x = 0 and x = -1.2.
std::vector<Point> simulate(int refinement);

/// Mean of |rho - rho_exact| over mean rho, over the waves and what they are smeared by: the fan begins at x = -0.178,
/// the shock is at 0.222.
double density_error(const std::vector<Point>& profile);

/// Mean of |f - f_exact| over mean f on a plateau, so that errors of either sign count.
double plateau_error(const std::vector<Point>& profile, double Point::*field, double from, double to);

Case make_case();

}  // namespace smelt::shock_tube
