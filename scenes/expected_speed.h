#pragma once
// How fast the fluid of a scene will get, before it moves: what its sound speed is measured by.

#include "scenes/build_simulation.h"

#include <string>

namespace smelt {

struct ExpectedSpeed {
  double speed = 0.0;  ///< [m/s]; with c the sound speed the density errs by (speed/c)^2
  std::string reason;  ///< how it was found
};

/// The least of
///  - a fall through the whole scene after the fastest start, sqrt(2 g H) + v_start, which nothing exceeds, and
///  - of the material that it is largest for, the largest of: sqrt(2 g H' + v_start^2) for the fall H' of the fluid
///    itself, from where it starts to what is below it; the surface of a layer of thickness d that runs down a slope,
///    gdot d n/(n + 1) with tau(gdot) = rho g sin(slope) d (of a Newtonian fluid rho g sin(slope) d^2/(2 mu)
///    [Huppert 1982]); and sqrt(g d), with which its weight compresses it.
/// Of bodies, d is the height, and the slope an upright face: their own. Of a vent, d is the thickness at which such a
/// layer as wide as the vent carries all that it pours, down the steepest of the ground, or off a pile d high and as
/// wide where that is steeper. Materials count as thin as they get where they are hot. Fluid that gathers in a vessel
/// is not foreseen.
ExpectedSpeed expect_speed(const SimulationSetup& setup);

}  // namespace smelt
