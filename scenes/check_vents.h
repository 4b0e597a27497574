#pragma once
// Vents must pour into the open.

#include "scenes/build_simulation.h"

namespace smelt {

/// Throws Error for a vent that cannot pour (core/sph/open_boundary.h), that a body fills, or any part of whose duct lies under a collider's surface or the ground
/// at the start. Says where the ground is there, and by how much to raise the vent.
void check_vents(const Scene& scene, const SimulationSetup& setup);

}  // namespace smelt
