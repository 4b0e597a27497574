#pragma once
// A viscoplastic layer on a slope of 30 degrees: it rests while rho g H sin(slope), the stress at its bed, is below the
// yield stress, and flows above. All with the relaxed stress, from equilibrium: no wave runs when the layer is let go.
// Units: the layer's thickness, its density and gravity are 1.

#include "bench/cases/case.h"

namespace smelt::slope {

/// Speed of the surface in steady flow, `ratio` times as thick as the critical layer: the integral of the shear rate
/// under a stress of along (1 - y).
double exact_speed(double ratio);

/// The surface's speed, averaged over the last unit of time before `end`: faint elastic waves go to and fro.
double run_layer(int n_rows, double ratio, double end, double h_over_spacing = 1.2);

Case make_case();

}  // namespace smelt::slope
