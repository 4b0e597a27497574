#include "core/geometry/mass_properties.h"

namespace smelt {

namespace {

/// Of the simplex between a facet and the origin, positive where the facet is wound outward.
double signed_volume(const Simplex<3>& f) {
  return f[0].dot(f[1].cross(f[2])) / 6.0;
}
double signed_volume(const Simplex<2>& f) {
  return 0.5 * (f[0][0] * f[1][1] - f[0][1] * f[1][0]);
}

}  // namespace

template <int Dim>
MassProperties<Dim> compute_mass_properties(std::span<const Simplex<Dim>> facets) {
  Box<Dim> bounds;
  for (const auto& facet : facets)
    for (const Vec<Dim>& x : facet) bounds.extend(x);
  MassProperties<Dim> sum;
  if (facets.empty()) return sum;
  // Seen from its middle, so that little cancels.
  const Vec<Dim> origin = bounds.centre();
  Vec<Dim> first = Vec<Dim>::Zero();
  for (const auto& facet : facets) {
    Simplex<Dim> corners = facet;
    Vec<Dim> total = Vec<Dim>::Zero();
    Mat<Dim> squares = Mat<Dim>::Zero();
    for (Vec<Dim>& a : corners) {
      a -= origin;
      total += a;
      squares += a * a.transpose();
    }
    const double volume = signed_volume(corners);
    sum.volume += volume;
    first += volume / (Dim + 1) * total;
    sum.second += volume / ((Dim + 1) * (Dim + 2)) * (total * total.transpose() + squares);
  }
  if (sum.volume == 0.0) return sum;
  const Vec<Dim> mean = first / sum.volume;
  sum.centre = origin + mean;
  sum.second -= sum.volume * mean * mean.transpose();
  return sum;
}

template MassProperties<2> compute_mass_properties<2>(std::span<const Simplex<2>>);
template MassProperties<3> compute_mass_properties<3>(std::span<const Simplex<3>>);

}  // namespace smelt
