#pragma once
// Vents must pour into the open, and stand on the ground without a gap.

#include "scenes/build_simulation.h"

namespace smelt {

/// Roots each emitter of `setup` that stands near a collider's surface, or the ground, so deep in it that fluid cannot
/// get under any part of its entry. Throws Error for a vent that cannot pour (core/sph/open_boundary.h), that a body
/// or another open vent fills, or any part of which lies under such a surface from its entry on; says where the ground
/// is there, and by how much to raise the vent. As things stand at the start.
void place_vents(const Scene& scene, SimulationSetup& setup);

}  // namespace smelt
