#include "render/environment.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace smelt {

namespace {

/// The first entry of the running sums that is above `value`, as a fraction of the way through it: u in [0, 1) becomes
/// (index, remainder in [0, 1)).
std::pair<int, float> invert(const float* sums, int n, float u) {
  const float value = u * sums[n - 1];
  const int k = std::min(static_cast<int>(std::upper_bound(sums, sums + n, value) - sums), n - 1);
  const float before = k == 0 ? 0.0f : sums[k - 1];
  return {k, std::clamp((value - before) / std::max(sums[k] - before, 1e-30f), 0.0f, 0.999999f)};
}

}  // namespace

EnvironmentMap::EnvironmentMap(const Environment& environment)
    : environment_(environment), rotation_(static_cast<float>(environment.rotate_deg * std::numbers::pi / 180.0)) {
  const RadianceImage& image = *environment_.image;
  const int w = image.width, h = image.height;
  const auto at = [&](int x, int y) {
    return image
        .pixels[static_cast<std::size_t>(std::clamp(y, 0, h - 1)) * static_cast<std::size_t>(w) +
                static_cast<std::size_t>((x + w) % w)]
        .sum();
  };
  row_sums_.resize(static_cast<std::size_t>(h));
  cell_sums_.resize(image.pixels.size());
  double total = 0.0, sphere = 0.0;
  for (int y = 0; y < h; ++y) {
    const float sine = std::sin(pi_f * (static_cast<float>(y) + 0.5f) / static_cast<float>(h));
    double row = 0.0;
    for (int x = 0; x < w; ++x) {
      // Interpolation carries light into the pixels around: a pixel weighs as its neighbourhood.
      float sum = 0.0f;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) sum += at(x + i, y + j);
      row += sine * sum;
      cell_sums_[static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x)] =
          static_cast<float>(row);
      total += sine * at(x, y);
      sphere += sine;
    }
    row_sums_[static_cast<std::size_t>(y)] =
        static_cast<float>(row) + (y == 0 ? 0.0f : row_sums_[static_cast<std::size_t>(y) - 1]);
  }
  mean_sum_ = static_cast<float>(total / sphere) * environment.strength;
}

EnvironmentMap::Place EnvironmentMap::place_of(const Vec3f& d) const {
  const auto w = static_cast<float>(environment_.image->width), h = static_cast<float>(environment_.image->height);
  // Turning the image counter-clockwise is looking clockwise into it.
  float around = 0.5f + (std::atan2(d.x(), -d.z()) + rotation_) / (2.0f * pi_f);
  around -= std::floor(around);
  return {around * w, std::acos(std::clamp(d.y(), -1.0f, 1.0f)) / pi_f * h};
}

Vec3f EnvironmentMap::radiance(const Vec3f& d) const {
  const RadianceImage& image = *environment_.image;
  const Place place = place_of(d);
  const float x = place.x - 0.5f, y = std::clamp(place.y - 0.5f, 0.0f, static_cast<float>(image.height - 1));
  const int x0 = static_cast<int>(std::floor(x)), y0 = std::min(static_cast<int>(y), std::max(0, image.height - 2));
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const auto at = [&](int i, int j) -> const Vec3f& {
    const int column = (i + image.width) % image.width, row = std::min(j, image.height - 1);
    return image.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                        static_cast<std::size_t>(column)];
  };
  const Vec3f upper = at(x0, y0) * (1.0f - fx) + at(x0 + 1, y0) * fx;
  const Vec3f lower = at(x0, y0 + 1) * (1.0f - fx) + at(x0 + 1, y0 + 1) * fx;
  return (upper * (1.0f - fy) + lower * fy) * environment_.strength;
}

Vec3f EnvironmentMap::sample(Sample2 s) const {
  const int w = environment_.image->width, h = environment_.image->height;
  const auto [row, in_row] = invert(row_sums_.data(), h, s.v);
  const auto [column, in_cell] =
      invert(&cell_sums_[static_cast<std::size_t>(row) * static_cast<std::size_t>(w)], w, s.u);
  const float theta = pi_f * (static_cast<float>(row) + in_row) / static_cast<float>(h);
  const float phi = 2.0f * pi_f * ((static_cast<float>(column) + in_cell) / static_cast<float>(w) - 0.5f) - rotation_;
  return {std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)};
}

float EnvironmentMap::pdf(const Vec3f& d) const {
  const int w = environment_.image->width, h = environment_.image->height;
  const Place place = place_of(d);
  const auto column = static_cast<std::size_t>(std::clamp(static_cast<int>(place.x), 0, w - 1));
  const auto row = static_cast<std::size_t>(std::clamp(static_cast<int>(place.y), 0, h - 1));
  const float* cells = &cell_sums_[row * static_cast<std::size_t>(w)];
  const float weight = cells[column] - (column == 0 ? 0.0f : cells[column - 1]);
  const float sine = std::sqrt(std::max(1e-12f, 1.0f - d.y() * d.y()));
  return weight / row_sums_.back() * static_cast<float>(w) * static_cast<float>(h) / (2.0f * pi_f * pi_f * sine);
}

}  // namespace smelt
