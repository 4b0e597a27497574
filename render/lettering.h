#pragma once
// Text in pictures: small letters five pixels wide and seven high.

#include "core/image.h"

#include <array>
#include <cstdint>
#include <string_view>

namespace smelt {

/// Width of a text in pixels, at `scale` screen pixels a pixel of a letter.
int text_width(std::string_view text, int scale);
inline int text_height(int scale) {
  return 7 * scale;
}

/// Writes `text` with its top left corner at (x, y); what is outside the picture is left out. Lower case, digits and
/// the punctuation of units and numbers; capitals as lower case where they have no letter of their own, others as a
/// box.
void draw_text(ImageRgb8& image, int x, int y, std::string_view text, int scale,
               const std::array<std::uint8_t, 3>& colour);

/// Fills the rectangle [x0, x1) x [y0, y1), as far as it is in the picture.
void fill_rectangle(ImageRgb8& image, int x0, int y0, int x1, int y1, const std::array<std::uint8_t, 3>& colour);

}  // namespace smelt
