#pragma once
// Light of a black body, as an eye and a display see it.

#include "core/geometry/vec.h"

#include <vector>

namespace smelt {

/// Planck's law: spectral radiance 2 h c^2 / lambda^5 / (exp(h c / (lambda k T)) - 1) [W m^-3 sr^-1] at `wavelength`
/// [m] and `temperature` [K], both above 0.
double planck_radiance(double wavelength, double temperature);

/// CIE 1931 colour matching functions (2 degrees) at `wavelength` [m], within 0.035 of the standard's tables: the sums
/// of Gaussians of [Wyman 2013], and beyond 640 nm, where their x falls off too fast, x from y. Black bodies from 1000
/// K on come out within 0.0015 of their chromaticity.
Vec3 cie_matching(double wavelength);

/// Luminance [cd/m^2] (683 lm/W) and chromaticity, as CIE XYZ: 683 times the integral of Planck's law with the matching
/// functions from 360 to 830 nm. `temperature` in kelvin, above 0.
Vec3 black_body_xyz(double temperature);

/// Linear Rec. 709 (sRGB) primaries, white D65, of CIE XYZ (IEC 61966-2-1).
Vec3 rgb_from_xyz(const Vec3& xyz);

/// Radiance of black bodies by temperature, tabulated once: logarithm of the luminance and chromaticity over 1/T, where
/// both are nearly straight. Error against black_body_xyz below 0.1 % between 500 K and 20000 K.
class BlackBodyTable {
 public:
  BlackBodyTable();
  /// Linear RGB whose luminance is that of the black body [cd/m^2]. Deep reds lie outside Rec. 709: channels below 0
  /// are set to 0 and the rest is scaled to the same luminance. Zero below 500 K (less than 1e-8 cd/m^2); 20000 K
  /// above.
  Vec3f operator()(float temperature) const;

 private:
  struct Entry {
    float log_luminance = 0.0f;
    Vec3f colour = Vec3f::Zero();  ///< of luminance 1
  };
  std::vector<Entry> entries_;
};

}  // namespace smelt
