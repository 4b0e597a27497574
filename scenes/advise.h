#pragma once
// What in a scene's numerical settings will cost accuracy or time, and what to choose instead.

#include "scenes/build_simulation.h"

#include <string>
#include <vector>

namespace smelt {

/// One sentence for each setting badly chosen: a sound speed too low or too high for the speeds expected, a relaxed
/// stress too soft, a viscosity that rules the step where a relaxed stress would not, a floor of the time step above
/// `time_step` [s], the first step of the shot. Empty where nothing is to be said.
std::vector<std::string> advise(const SimulationSetup& setup, double time_step);

}  // namespace smelt
