#pragma once
// Where a surface can be: everything dear is done there alone, so that its cost follows the surface and not the volume.

#include "surfacing/particle_bins.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace smelt {

/// Nodes of a lattice one particle spacing apart, in blocks of 8 x 8 x 8, each either deep inside the fluid or not.
///
/// A node is deep when the volume of the particles around it fills space: f = [1 2 1]/4 along each axis of the particle
/// volumes, spread to nodes with trilinear weights, over the volume of a node's cell, is at least `deep_filling`. f has
/// half a spacing more width than chi, and on a flat surface chi = 0.5 lies where f = 0.5, so about a spacing of fluid
/// counts as surface on either side. What f cannot see is a cavity inside the fluid, too small to lower f to
/// `deep_filling` and yet with chi below the iso-value: such cavities, of less than a tenth of a particle's volume, are
/// filled.
struct SurfaceRegion {
  static constexpr double deep_filling = 0.90;

  double node = 0.0;                                  ///< distance between nodes [m]
  std::vector<std::uint64_t> key;                     ///< lattice_key of each block with particles, ascending
  std::vector<std::array<std::uint64_t, 8>> shallow;  ///< of each: bit i + 8 j of word k: node (i, j, k) is not deep

  /// Whether the box holds a node that is not deep, on it and one node beyond it included. Nodes of blocks without
  /// particles are not deep.
  bool touches_surface(const Box3& box) const;
};

/// `volume` [m^3] in the order of `bins`, `node` [m].
SurfaceRegion find_surface_region(const ParticleBins& bins, std::span<const float> volume, double node);

}  // namespace smelt
