#pragma once
// A step of temperature on a jittered lattice, which spreads as the error function.

#include "bench/cases/case.h"
#include "core/sph/solver.h"

namespace smelt::heat_step {

constexpr double diffusivity = 0.1;  ///< [m^2/s]
constexpr double cold = 300.0;       ///< [K]; the warm side is one kelvin warmer
constexpr double width = 0.5;        ///< [m] after which the strip repeats

double start_temperature(const Vec<2>& x);

/// A strip 2 m long that repeats after half a metre across, one kelvin warmer for x < 0, at rest: density is at rest,
/// so nothing moves. The lattice's jitter depends on `seed`.
Solver<2, double> make_strip(double spacing, double h_over_spacing, double jitter, int seed);

/// The exact temperature above the cold side. The table's rows are its values; between them a straight line is off by
/// more than the method.
double exact(double x, double time);

/// Root mean square of what the temperatures are off [K], over the particles away from the ends.
double l2_error(const Solver<2, double>& solver, double time);

Case make_case();

}  // namespace smelt::heat_step
