#pragma once
// The skin of lava and rock: plates with cracks between them.

#include "core/geometry/vec.h"
#include "render/scene_view.h"

namespace smelt {

/// The crust at one place of the unmoved material.
struct CrustSample {
  float cover = 0.0f;   ///< 0 in a crack, 1 on a plate
  float height = 0.0f;  ///< of the relief [m]
  float tone = 0.0f;    ///< of the colour, about 0, mostly within [-1, 1]
};

/// `rest`: place in the unmoved material [m]; `solid`: 0 liquid, 1 set. Cracks are widest where it is liquid.
CrustSample sample_crust(const CrustLook& look, const Vec3f& rest, float solid);

/// How much cooler than the fluid under it the crust is [K]: look.cooler_K on a plate that has set, two fifths of it on
/// one that floats on liquid, nothing in a crack.
float crust_cooling(const CrustLook& look, float cover, float solid);

}  // namespace smelt
