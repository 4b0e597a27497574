#pragma once
// A picture in memory: what render makes and io writes.

#include <array>
#include <cstdint>
#include <vector>

namespace smelt {

/// 8-bit sRGB, row-major from the top left, three bytes a pixel.
struct ImageRgb8 {
  int width = 0;
  int height = 0;
  std::vector<std::array<std::uint8_t, 3>> pixels;
};

}  // namespace smelt
