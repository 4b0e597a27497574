#pragma once
// Filling a closed mesh with particles.

#include "core/geometry/triangle_mesh.h"

#include <cstdint>
#include <vector>

namespace smelt {

/// Exactly one of `count` and `spacing` is positive, the other is zero.
struct SeedingOptions {
  std::int64_t count = 0;  ///< particles wanted
  double spacing = 0.0;    ///< of the lattice [m]
  double jitter = 0.0;     ///< greatest shift along each axis as a fraction of the lattice spacing, in [0, 0.5)
  std::uint64_t seed = 0;  ///< chooses the jitter
};

struct Seeds {
  std::vector<Vec3> positions;      ///< [m], x fastest, then y, then z; those in thin parts come last
  std::size_t n_in_thin_parts = 0;  ///< positions that are no lattice sites
  double spacing = 0.0;             ///< cbrt(volume / n) [m]: n density spacing^3 is the mass of the body, exactly
  double lattice_spacing = 0.0;     ///< distance between neighbouring lattice sites [m]
  double volume = 0.0;              ///< of the mesh [m^3]
};

/// The sites of a cubic lattice that lie inside `mesh` (winding number not zero, decided exactly but for rounding in
/// x), and places in parts so thin that no site is near (core/geometry/thin_parts.h). The lattice starts half a spacing
/// from the lower corner of the mesh's bounds. `count` is met exactly for most shapes; where the lattice misses it by
/// more than 1 % (a cube holds n^3 sites and nothing between), lattices centred on the bounds are tried too, and the
/// nearest number attainable is taken. Jitter is a hash of seed and lattice site, so it does not depend on the order of
/// work; a particle that would leave the body by it stays on its lattice site, and those in thin parts stay too. Throws
/// Error for options out of range, a mesh that is not closed or is wound inward, a count missed by more than 10 %, and
/// a body too thin for the spacing (the cells of all sites more than 20 % off the volume; the text names a spacing that
/// would do).
Seeds seed_particles(const TriangleMesh& mesh, const SeedingOptions& options);

}  // namespace smelt
