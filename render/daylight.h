#pragma once
// Sun and sky of a clear day.

#include "render/scene_view.h"

namespace smelt {

struct Daylight {
  Vec3 to_sun{0.0, 1.0, 0.0};  ///< unit
  double haze = 1.0;           ///< factor on the aerosols of clear air, in [0.1, 10]
};

/// Radiance of the sky: sunlight scattered once by air (Rayleigh) and aerosols (Henyey-Greenstein, g = 0.76) in a
/// spherical atmosphere [Nishita 1993], at 680, 550 and 440 nm for red, green and blue; integrated in 24 steps along
/// the view. Below the horizon the ground, of albedo 0.15, lit by both. Scattering more than once is left out: the real
/// sky is brighter, most of all near the horizon. A sun straight above, outside the atmosphere, would give a
/// horizontal white surface a radiance of 1.2. Equirectangular, as Environment wants it.
RadianceImage make_sky(const Daylight& day, int width = 256, int height = 128);

/// The sun's disk, dimmed and reddened by the same atmosphere; black where it is below the horizon.
Sun make_sun(const Daylight& day);

}  // namespace smelt
