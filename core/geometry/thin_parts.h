#pragma once
// Seeds for what a lattice passes by: rims, fins and tips of a body that are thinner than the lattice is wide.

#include "core/geometry/inside.h"
#include "core/geometry/lattice_sites.h"

#include <vector>

namespace smelt {

/// Places [m] in the middle of those thin parts of a closed mesh that no site of the lattice is near. The surface is
/// looked at about every half spacing. Where no site is within 1.2 spacings, which is about what sites leave free at
/// most before the flat side of a wide body, and the opposite wall is less than a spacing away straight inward, the
/// place half way to that wall is taken, unless it is nearer than 0.85 spacings to a site or to a place taken before;
/// those nearest to the sites come first, so that fins fill from the body outward, about 1.2 spacings apart. Parts as
/// wide as the lattice get none. The same on any number of threads.
std::vector<Vec3> fill_thin_parts(const TriangleMesh& mesh, const InsideTest& inside, const LatticeSites& sites);

}  // namespace smelt
