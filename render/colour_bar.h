#pragma once
// The scale beside a picture in false colours.

#include "core/image.h"
#include "render/colour_map.h"

#include <string>
#include <vector>

namespace smelt {

/// What the colours of a picture stand for.
struct ColourScale {
  std::string label;  ///< name and unit: "temperature [K]"
  double low = 0.0;   ///< value of the first colour
  double high = 1.0;  ///< of the last, above low
  bool logarithmic = false;

  /// Where a value is on the scale, 0 at `low` and 1 at `high`; may lie outside.
  double place(double value) const;
};

/// Round values within the scale, in order: steps of 1, 2 or 5 times a power of ten, about `n` of them; on a
/// logarithmic scale powers of ten, and 2 and 5 times those where that leaves too few.
std::vector<double> compute_ticks(const ColourScale& scale, int n);

/// A bar at the right of the picture with ticks and its label, over what is there.
void draw_colour_bar(ImageRgb8& image, const ColourScale& scale, const ColourMap& map);

}  // namespace smelt
