#pragma once
// Colliders as they come: which of them bound a solid, and what of the fluid stands where it cannot.

#include "scenes/build_simulation.h"

#include <cstddef>
#include <string>
#include <vector>

namespace smelt {

/// Winds the faces of collider `k`, as it was read, alike (core/geometry/orientation.h) and drops those that lie on
/// others; adds to the warnings what was done, and what cannot be.
void wind_collider(const Scene& scene, std::size_t k, TriangleMesh& mesh, std::vector<std::string>& warnings);

/// Decides for every collider of `setup` but the ground whether it bounds a solid (docs/conventions.md), turns those
/// that are wound inward (and sheets so that they look up), leaves out the particles that start inside a solid, and
/// adds to the warnings what was done and what looks wrong: winding, holes, a size that no unit fits, a sheet that cuts
/// through a body. `first[k]` is the first particle of body k; one more entry ends the last. Throws Error, naming both
/// files, where a body is neither inside a solid nor outside it: more than half of its particles lie in, but not all.
void prepare_colliders(const Scene& scene, const std::vector<std::size_t>& first, SimulationSetup& setup);

}  // namespace smelt
