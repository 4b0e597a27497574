#include "render/contact_sheet.h"

#include "core/error.h"
#include "render/tone_map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace smelt {

namespace {

std::array<float, 256> linear_table() {
  std::array<float, 256> table;
  for (std::size_t k = 0; k < 256; ++k) table[k] = linear_from_srgb(static_cast<float>(k) / 255.0f);
  return table;
}

/// Mean light over the part of the picture that a smaller pixel covers, edges weighed by how much of them it covers.
ImageRgb8 shrink(const ImageRgb8& from, int width, int height) {
  if (width == from.width && height == from.height) return from;
  const std::array<float, 256> linear = linear_table();
  ImageRgb8 to{width, height, {}};
  to.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const double sx = static_cast<double>(from.width) / width, sy = static_cast<double>(from.height) / height;
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      Vec3f sum = Vec3f::Zero();
      float total = 0.0f;
      const auto last = [](double end, int size) { return std::min(size - 1, static_cast<int>(std::ceil(end)) - 1); };
      for (int j = static_cast<int>(y * sy); j <= last((y + 1) * sy, from.height); ++j)
        for (int i = static_cast<int>(x * sx); i <= last((x + 1) * sx, from.width); ++i) {
          const auto share = [](double low, double high, int k) {
            return std::min(high, k + 1.0) - std::max(low, static_cast<double>(k));
          };
          const auto weight = static_cast<float>(share(x * sx, (x + 1) * sx, i) * share(y * sy, (y + 1) * sy, j));
          const auto& p = from.pixels[static_cast<std::size_t>(j) * static_cast<std::size_t>(from.width) +
                                      static_cast<std::size_t>(i)];
          sum += weight * Vec3f(linear[p[0]], linear[p[1]], linear[p[2]]);
          total += weight;
        }
      to.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
          quantize_srgb(sum / total, 0.0f);
    }
  });
  return to;
}

}  // namespace

ImageRgb8 make_contact_sheet(const std::vector<ImageRgb8>& pictures, int n_columns, int max_width) {
  CHECK(!pictures.empty());
  constexpr int gap = 6;
  const int w = pictures.front().width, h = pictures.front().height;
  for (const ImageRgb8& picture : pictures)
    if (picture.width != w || picture.height != h)
      fail("the pictures of a sheet must be of one size, but one is {} x {} and another {} x {}; draw them again", w, h,
           picture.width, picture.height);
  const int n_rows = (static_cast<int>(pictures.size()) + n_columns - 1) / n_columns;
  const int width = std::min(w, std::max(1, (max_width - gap * (n_columns + 1)) / n_columns));
  const int height = std::max(1, static_cast<int>(std::lround(static_cast<double>(h) * width / w)));
  ImageRgb8 sheet{n_columns * (width + gap) + gap, n_rows * (height + gap) + gap, {}};
  sheet.pixels.assign(static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height), {255, 255, 255});
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const ImageRgb8 small = shrink(pictures[k], width, height);
    const int left = gap + static_cast<int>(k) % n_columns * (width + gap),
              top = gap + static_cast<int>(k) / n_columns * (height + gap);
    for (int y = 0; y < height; ++y)
      std::copy_n(&small.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)], width,
                  &sheet.pixels[static_cast<std::size_t>(top + y) * static_cast<std::size_t>(sheet.width) +
                                static_cast<std::size_t>(left)]);
  }
  return sheet;
}

}  // namespace smelt
