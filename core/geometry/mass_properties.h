#pragma once
// Volume, centre and second moments of a solid bounded by facets.

#include "core/geometry/facet.h"

#include <span>

namespace smelt {

template <int Dim>
struct MassProperties {
  double volume = 0.0;                 ///< [m^Dim]; negative where the facets are wound inward
  Vec<Dim> centre = Vec<Dim>::Zero();  ///< of mass at even density [m]
  Mat<Dim> second = Mat<Dim>::Zero();  ///< int (x - centre) (x) (x - centre) dV [m^(Dim + 2)]: the inertia tensor is
                                       ///< its trace less itself
};

/// Exact but for rounding, for facets that close, wound outward (docs/conventions.md): the sum over the simplices
/// between each facet and one point, of int x (x) x dV = V ((sum a)(x)(sum a) + sum a (x) a) / ((Dim + 1)(Dim + 2))
/// over the corners a seen from there. In 2 and 3 dimensions.
template <int Dim>
MassProperties<Dim> compute_mass_properties(std::span<const Simplex<Dim>> facets);

}  // namespace smelt
