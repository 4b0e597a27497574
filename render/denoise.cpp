#include "render/denoise.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <experimental/simd>
#include <span>
#include <type_traits>
#include <utility>

namespace smelt {

namespace {

namespace stdx = std::experimental;
// Eight pixels at a time, the width that every machine we run on has: the same sums, so the same bytes, everywhere.
using Lanes = stdx::simd<float, stdx::simd_abi::deduce_t<float, 8>>;

constexpr int rows_per_task = 8;

/// Runs `row(y)` for every row of the picture. Rows are independent, so threads change nothing.
template <typename Row>
void for_each_row(int height, const Row& row) {
  tbb::parallel_for(tbb::blocked_range<int>(0, height, rows_per_task), [&](const tbb::blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) row(y);
  });
}

/// Mean over (2 radius + 1)^2 pixels, borders repeated: a variance from four samples is itself too noisy to be a guide.
void blur(Plane& plane, Plane& scratch, int width, int height, int radius) {
  const float scale = 1.0f / static_cast<float>(2 * radius + 1);
  for_each_row(height, [&](int y) {
    const float* from = &plane[static_cast<std::size_t>(y) * width];
    float* to = &scratch[static_cast<std::size_t>(y) * width];
    for (int x = 0; x < width; ++x) {
      float sum = 0.0f;
      for (int k = -radius; k <= radius; ++k) sum += from[std::clamp(x + k, 0, width - 1)];
      to[x] = sum * scale;
    }
  });
  for_each_row(height, [&](int y) {
    float* to = &plane[static_cast<std::size_t>(y) * width];
    std::fill(to, to + width, 0.0f);
    for (int k = -radius; k <= radius; ++k) {
      const float* from = &scratch[static_cast<std::size_t>(std::clamp(y + k, 0, height - 1)) * width];
      for (int x = 0; x < width; ++x) to[x] += from[x] * scale;
    }
  });
}

template <typename V>
[[gnu::always_inline]] inline V load(const float* from) {
  if constexpr (std::is_same_v<V, float>) {
    return *from;
  } else {
    return V(from, stdx::element_aligned);
  }
}

template <typename V>
[[gnu::always_inline]] inline void store(const V& value, float* to) {
  if constexpr (std::is_same_v<V, float>) {
    *to = value;
  } else {
    value.copy_to(to, stdx::element_aligned);
  }
}

template <typename V>
[[gnu::always_inline]] inline V positive(const V& value) {
  if constexpr (std::is_same_v<V, float>) {
    return value > 0.0f ? value : 0.0f;
  } else {
    return stdx::max(value, V(0.0f));
  }
}

template <typename V>
[[gnu::always_inline]] inline V luminance_of(const V& r, const V& g, const V& b) {
  return 0.2126f * r + 0.7152f * g + 0.0722f * b;
}

/// The first pixels of the planes that a level reads and writes.
struct Source {
  const float *r, *g, *b, *variance, *nx, *ny, *nz, *px, *py, *pz, *kind;
};
struct Target {
  float *r, *g, *b, *variance;
};

/// A neighbour of a pixel: how far off it is in memory, and its weight by distance alone.
struct Tap {
  std::ptrdiff_t offset;
  float kernel;
};

/// 1 / tolerance^2 of one level.
struct Tolerance {
  float sigmas2;  ///< of luminance; infinite: luminance does not count
  float per_normal2;
  float slope2;  ///< (tolerance of tangent planes / distance from the eye)^2
};

/// Filters the pixels from `i` on: one (V = float) or eight of them.
template <typename V>
void filter_pixels(const Source& in, const Target& out, std::size_t i, std::span<const Tap> taps,
                   const Tolerance& tolerance) {
  const V nx = load<V>(in.nx + i), ny = load<V>(in.ny + i), nz = load<V>(in.nz + i);
  const V px = load<V>(in.px + i), py = load<V>(in.py + i), pz = load<V>(in.pz + i);
  const V kind = load<V>(in.kind + i);
  const V lum = luminance_of(load<V>(in.r + i), load<V>(in.g + i), load<V>(in.b + i));
  // A floor under the tolerance, 1/2000 of the luminance: less than the eye or eight bits can tell.
  const V per_lum2 = 1.0f / (tolerance.sigmas2 * load<V>(in.variance + i) + 2.5e-7f * lum * lum + 1e-12f);
  const V per_plane2 = 1.0f / (tolerance.slope2 * (px * px + py * py + pz * pz) + 1e-20f);
  V sum_r(0.0f), sum_g(0.0f), sum_b(0.0f), sum_variance(0.0f), sum_weight(0.0f);
  for (const Tap& tap : taps) {
    const std::size_t o = i + static_cast<std::size_t>(tap.offset);
    const V dnx = nx - load<V>(in.nx + o), dny = ny - load<V>(in.ny + o), dnz = nz - load<V>(in.nz + o);
    const V dz = nx * (px - load<V>(in.px + o)) + ny * (py - load<V>(in.py + o)) + nz * (pz - load<V>(in.pz + o));
    const V dk = kind - load<V>(in.kind + o);
    const V r = load<V>(in.r + o), g = load<V>(in.g + o), b = load<V>(in.b + o);
    const V dl = lum - luminance_of(r, g, b);
    const V root = positive<V>(1.0f - (dnx * dnx + dny * dny + dnz * dnz) * tolerance.per_normal2) *
                   positive<V>(1.0f - dz * dz * per_plane2) * positive<V>(1.0f - dk * dk) *
                   positive<V>(1.0f - dl * dl * per_lum2);
    const V weight = tap.kernel * root * root;
    sum_r += weight * r;
    sum_g += weight * g;
    sum_b += weight * b;
    sum_variance += weight * weight * load<V>(in.variance + o);
    sum_weight += weight;
  }
  // A pixel always counts itself, so the weight is never zero.
  const V per_weight = 1.0f / sum_weight;
  store<V>(sum_r * per_weight, out.r + i);
  store<V>(sum_g * per_weight, out.g + i);
  store<V>(sum_b * per_weight, out.b + i);
  store<V>(sum_variance * per_weight * per_weight, out.variance + i);
}

constexpr std::array<float, 5> spline{1.0f / 16, 4.0f / 16, 6.0f / 16, 4.0f / 16, 1.0f / 16};

/// The neighbours, `step` pixels apart, of a pixel in column `x` and row `y`; `n_pixels` of them side by side if more
/// than one.
std::span<const Tap> taps_at(std::array<Tap, 25>& taps, int x, int y, int n_pixels, int width, int height, int step) {
  std::size_t n = 0;
  for (int j = -2; j <= 2; ++j) {
    if (y + j * step < 0 || y + j * step >= height) continue;
    for (int i = -2; i <= 2; ++i) {
      if (x + i * step < 0 || x + n_pixels - 1 + i * step >= width) continue;
      taps[n++] = {static_cast<std::ptrdiff_t>(j * step) * width + i * step,
                   spline[static_cast<std::size_t>(i + 2)] * spline[static_cast<std::size_t>(j + 2)]};
    }
  }
  return std::span(taps).first(n);
}

/// One row of one level: eight pixels at a time where all their neighbours are in the picture, singly at the sides.
void filter_row(const Source& in, const Target& out, const Plane& mask, int y, int width, int height, int step,
                const Tolerance& tolerance) {
  std::array<Tap, 25> taps;
  const std::size_t start = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  const int margin = 2 * step, n_lanes = static_cast<int>(Lanes::size());
  const auto copy = [&](std::size_t i) {
    out.r[i] = in.r[i];
    out.g[i] = in.g[i];
    out.b[i] = in.b[i];
    out.variance[i] = in.variance[i];
  };
  int x = 0;
  std::span<const Tap> inner;
  while (x < width) {
    const std::size_t i = start + static_cast<std::size_t>(x);
    if (x >= margin && x + n_lanes + margin <= width) {
      if (inner.empty()) inner = taps_at(taps, x, y, n_lanes, width, height, step);
      const bool wanted = std::any_of(&mask[i], &mask[i] + n_lanes, [](float m) { return m != 0.0f; });
      if (wanted) {
        filter_pixels<Lanes>(in, out, i, inner, tolerance);
      } else {
        for (std::size_t k = 0; k < Lanes::size(); ++k) copy(i + k);
      }
      x += n_lanes;
    } else {
      std::array<Tap, 25> own;
      if (mask[i] != 0.0f) {
        filter_pixels<float>(in, out, i, taps_at(own, x, y, 1, width, height, step), tolerance);
      } else {
        copy(i);
      }
      ++x;
    }
  }
}

}  // namespace

void denoise(Plane3& light, Plane& variance, const Film& guides, const Plane& mask, float pixels_per_radian,
             const DenoiseOptions& options) {
  const int width = guides.width, height = guides.height;
  Plane3 filtered{Plane(guides.size()), Plane(guides.size()), Plane(guides.size())};
  Plane filtered_variance(guides.size());
  blur(variance, filtered_variance, width, height, 2);
  const auto& n = guides.normal;
  const auto& p = guides.position;
  for (int l = 0; l < options.n_levels; ++l) {
    const int step = 1 << l;
    const float slope = options.plane_width / pixels_per_radian * static_cast<float>(step);
    const bool by_luminance = l >= options.first_luminance_level;
    const Tolerance tolerance{by_luminance ? options.luminance_sigmas * options.luminance_sigmas : 1e30f,
                              1.0f / (options.normal_width * options.normal_width), slope * slope};
    const Source in{light[0].data(), light[1].data(), light[2].data(), variance.data(), n[0].data(),       n[1].data(),
                    n[2].data(),     p[0].data(),     p[1].data(),     p[2].data(),     guides.kind.data()};
    const Target out{filtered[0].data(), filtered[1].data(), filtered[2].data(), filtered_variance.data()};
    for_each_row(height, [&](int y) { filter_row(in, out, mask, y, width, height, step, tolerance); });
    std::swap(light, filtered);
    std::swap(variance, filtered_variance);
    // Luminance told us nothing so far; from here on its noise must be known well.
    if (!by_luminance) blur(variance, filtered_variance, width, height, 2);
  }
}

}  // namespace smelt
