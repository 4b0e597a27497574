#pragma once
// Light whose amount is known: the furnace, and the floor under a glowing sphere. What is off is noise, and falls with
// samples.

#include "bench/cases/case.h"

namespace smelt::furnace {

/// White spheres in a white room cannot be seen.
Case make_furnace_case();

/// A black body's light on a floor: pi L (R/d)^2 at the foot of a sphere of radius R whose centre is d above it, L from
/// Planck's law.
Case make_black_body_case();

}  // namespace smelt::furnace
