#pragma once
// The lid-driven square cavity at Re = 1 [S 4.5.2] against finite differences: four walls, one of which slides. Side,
// lid speed, density and viscosity are 1.

#include "bench/cases/case.h"
#include "bench/cases/reference.h"
#include "core/sph/solver.h"

namespace smelt::cavity {

/// The box at rest. Its facets run clockwise, so that they face the fluid.
Solver<2, double> make_cavity(int across);

struct Errors {
  double u = 0.0;  ///< largest difference on x = 0.5
  double v = 0.0;  ///< on y = 0.5
};

/// From one spacing off the walls on: nearer, a mean of the fluid is one-sided.
Errors measure(const Solver<2, double>& solver, const Reference& reference, int across);

Case make_case();

}  // namespace smelt::cavity
