#pragma once
// The area of free surface that each particle stands for (docs/decisions/0011-heat-at-the-free-surface.md).

#include "core/sph/kernel.h"
#include "core/sph/neighbours.h"
#include "core/sph/periodic.h"
#include "core/sph/walls.h"

#include <span>
#include <vector>

namespace smelt {

/// Where the particles are. Row entries of `lists` from the number of particles on name periodic images.
template <int Dim>
struct FreeSurfaceInput {
  std::span<const Vec<Dim>> position;  ///< [m]
  std::span<const double> volume;      ///< V [m^Dim]
  const PeriodicImages<Dim>& images;
  const NeighbourLists& lists;  ///< reaching at least as far as the kernel
  const Walls<Dim>* walls;      ///< or nullptr
  KernelType kernel;
  double smoothing_length;  ///< h [m]
  double spacing;           ///< dx of the particles at rest [m]
};

/// Areas [m^(Dim - 1)], 0 inside; of the ends of a line in 1D, the number of ends. Walls do not count as surface.
///
/// With s_i = sum V_j grad_w_ij + (the walls' part), about -n delta, the outward normal is n_i = -s_i/|s_i|. A particle
/// is at the surface with a weight w_i in [0, 1]: 1 where no neighbour and no wall stands in the cone of 60 degrees
/// about n_i within two spacings [after Marrone 2010], or where the particle is all but alone (the trace of sum V_j
/// (x_j - x_i).grad_w_ij, walls included, is a fraction of Dim). The surface itself is taken half a spacing out along
/// n_i, at y_i. Its area is what the weights' density over the surface says,
///   A_i = w_i / sum_j w_j min(1, max(0, 2 n_i.n_j)) K(y_ij),
/// K the kernel of a space of one dimension less, integrating to 1 over a plane, y_ij the distance along it, and the
/// particle itself included: the areas on any flat surface add up to it. A sheet one particle thick counts once, not
/// twice; a lone particle as 2.2 h^2.
template <int Dim>
void compute_free_surface_areas(const FreeSurfaceInput<Dim>& input, std::vector<double>& area);

}  // namespace smelt
