#pragma once
// Colours for numbers.

#include "core/geometry/vec.h"

#include <array>

namespace smelt {

/// Linear Rec. 709 of Oklab's lightness, green-red and blue-yellow [Ottosson 2020]; channels may leave [0, 1].
Vec3 rgb_from_oklab(const Vec3& lab);
/// Its inverse.
Vec3 oklab_from_rgb(const Vec3& rgb);

/// From dark violet over teal and green to light yellow: lightness rises evenly and the hue turns evenly, as colourful
/// as a display can, sampled at equal distances in Oklab. So equal steps of a number look equally large, in grey too.
class ColourMap {
 public:
  ColourMap();
  /// Linear display colour at `t`, which is taken as 0 below and 1 above [0, 1].
  Vec3f operator()(float t) const;

 private:
  static constexpr int n_ = 256;
  std::array<Vec3f, n_> colours_;
};

}  // namespace smelt
