#pragma once
// An edge-preserving filter for the light in a picture.

#include "render/film.h"

namespace smelt {

struct DenoiseOptions {
  int n_levels = 5;                ///< the filter reaches 2^(n_levels + 1) - 2 pixels to each side
  int first_luminance_level = 2;   ///< levels before this one ignore luminance: what is that small counts as noise
  float luminance_sigmas = 16.0f;  ///< differences beyond that many standard deviations of the noise count as detail
  float normal_width = 0.5f;       ///< length of the difference of two unit normals at which pixels stop sharing light
  float plane_width = 4.0f;  ///< distance from the tangent plane, in pixels' footprints, at which they stop sharing
};

/// Replaces `light` by weighted means over its neighbourhood, and `variance` by the variance of those means:
/// edge-avoiding a-trous wavelets [Dammertz 2010] with a luminance weight guided by the variance [Schied 2017, eqs. 3
/// to 5]. Each weight is a product of (1 - d^2)^2 over the distances d of normals, tangent planes, kinds of surface and
/// luminance. Weights are normalised: a constant picture stays as it is, and no value leaves the range of its
/// neighbours. `guides` are read for normal, position and kind; `pixels_per_radian` gives the footprint of a pixel.
/// Pixels where `mask` is 0 may be left as they are, to save time. `light` and `variance` may be members of `guides`.
void denoise(Plane3& light, Plane& variance, const Film& guides, const Plane& mask, float pixels_per_radian,
             const DenoiseOptions& options);

}  // namespace smelt
