#pragma once
// A picture in memory: what render makes and io reads and writes.

#include "core/geometry/vec.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace smelt {

/// sRGB, row-major from the top left, three numbers a pixel.
template <typename Channel>
struct ImageRgb {
  int width = 0;
  int height = 0;
  std::vector<std::array<Channel, 3>> pixels;
};
using ImageRgb8 = ImageRgb<std::uint8_t>;
using ImageRgb16 = ImageRgb<std::uint16_t>;

/// Linear Rec. 709 radiance, unbounded, row-major from the top left.
struct RadianceImage {
  int width = 0;
  int height = 0;
  std::vector<Vec3f> pixels;
};

/// One channel of a picture in layers; names as in OpenEXR: `layer.channel`, the plain picture's without a layer.
struct ImageChannel {
  std::string name;
  std::vector<float> values;  ///< row-major from the top left
};

/// Linear, unbounded, in any number of channels of the same size.
struct LayeredImage {
  int width = 0;
  int height = 0;
  std::vector<ImageChannel> channels;
};

}  // namespace smelt
