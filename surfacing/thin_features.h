#pragma once
// Keeping drops and threads at their volume, and the smoothing away from them.

#include "surfacing/particle_bins.h"
#include "surfacing/surface_region.h"

#include <algorithm>
#include <span>
#include <vector>

namespace smelt {

/// How full the surroundings of each particle are, itself included: c_i = sum_j V_j W(x_i - x_j, h), no unit, in the
/// order of `bins`; `volume` [m^3] likewise, h [m]. On a cubic lattice:
///   h / spacing   bulk   flat surface   sheet one particle thick   thread of 2 x 2   thread   alone
///             1   1.00   0.85           0.70                       0.72              0.48     0.32
///             2   1.00   0.67           0.35                       0.35              0.12     0.04
/// With a `region`, 1 for particles whose bins are farther than `filling_reach` nodes from it: there c is above 0.6,
/// which is all that anybody asks.
std::vector<float> compute_filling(const ParticleBins& bins, std::span<const float> volume, double h,
                                   const SurfaceRegion* region = nullptr);
constexpr double filling_reach = 0.5;

/// What thin features are measured by.
struct ThinFeatureSettings {
  double spacing = 0.0;  ///< between particles [m]
  double h = 0.0;        ///< smoothing length of chi's kernel [m]
  double cell = 0.0;     ///< distance between samples [m], at most 1.5 h
  double iso = 0.0;      ///< of chi
  double gain = 0.0;     ///< SurfacingOptions::thin_feature_gain, > 0
};

/// Raises the `volume` that particles of thin features carry into chi, so that drops, threads and sheets keep theirs. A
/// lone particle has chi = 1/(pi (h/spacing)^3) at most, a thread half as much again: below the iso-value both would
/// disappear. c_j is the `filling` at twice the spacing.
///
/// 1. V_j *= (0.40/c_j)^(gain/2) where c_j is below 0.40. The one law gives lone particles, pairs, threads and thin
///    sheets their volumes (docs/decisions/0004-marching-cubes.md holds the table) at h = spacing and iso = 0.5, and
///    leaves flat surfaces as they are.
/// 2. V_j *= iso_j / chi(x_j) where chi at the particle itself is still below iso_j, the least at which a lone particle
///    is a drop of the radius r_j: iso_j = iso W(0)/W(r_j, h). r_j is the lesser of 0.445 h and that of a drop of its
///    own volume, 0.62 spacing, and half the diagonal of a cell at least where smoothing leaves drops alone
///    (`smoothing_strength`): a sample then lies inside wherever the particle is. So no particle disappears, whatever
///    h, iso and cell. From c_j = 0.40 to 0.60 the factor fades to 1: flat surfaces, at 0.67, stay whatever the
///    iso-value.
///
/// Beyond h = spacing threads and sheets come out thicker than their particles: at h = 1.4, 2 and 3 spacings
/// sheets 1.2, 1.6 and 2.3 times, threads with 1.6, 3 and 6 times their volume. Lone drops have 0.9 of theirs there,
/// where cells are fine; with cells above a spacing they grow with the cell, to 2.8 volumes at 1.25 and 6.4 at 1.5.
/// Both are continuous in the positions: nothing pops from frame to frame.
void strengthen_thin_features(std::span<float> volume, const ParticleBins& bins, std::span<const float> filling,
                              const ThinFeatureSettings& settings);

/// How strongly the surface near a particle may be smoothed, in [0, 1], from its filling at h = 2 spacing: 0 on threads
/// and drops, which smoothing would pinch off, 1 on flat surfaces. The wide kernel tells a thread from a lone particle
/// that sticks out of a surface, which should be smoothed away.
inline float smoothing_strength(float wide_filling) {
  return std::clamp((wide_filling - 0.15f) / (0.60f - 0.15f), 0.0f, 1.0f);
}

}  // namespace smelt
