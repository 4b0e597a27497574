#include "render/colour_bar.h"

#include "render/lettering.h"
#include "render/tone_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

constexpr std::array<std::uint8_t, 3> ink{30, 30, 30};

std::vector<double> linear_ticks(double low, double high, int n) {
  const double rough = (high - low) / std::max(1, n);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = power;
  for (const double factor : {2.0, 5.0, 10.0})
    if (step < rough) step = factor * power;
  std::vector<double> ticks;
  const double slack = 1e-9 * (high - low);
  for (double k = std::ceil((low - slack) / step); k * step <= high + slack; k += 1.0) ticks.push_back(k * step);
  return ticks;
}

std::vector<double> logarithmic_ticks(double low, double high, int n) {
  std::vector<double> ticks;
  const double decades = std::log10(high / low);
  const std::vector<double> factors = decades < 1.0 ? std::vector<double>{1.0, 2.0, 5.0} : std::vector<double>{1.0};
  const int every = std::max(1, static_cast<int>(std::ceil(decades / std::max(1, n))));
  for (int e = static_cast<int>(std::floor(std::log10(low) - 1e-9)); e <= std::log10(high) + 1e-9; ++e)
    for (const double factor : factors) {
      const double value = factor * std::pow(10.0, e);
      if (e % every == 0 && value >= low * (1.0 - 1e-9) && value <= high * (1.0 + 1e-9)) ticks.push_back(value);
    }
  return ticks;
}

std::string tick_text(double value, double range) {
  if (std::abs(value) < 1e-9 * range) return "0";
  return fmt::format("{:.5g}", value);
}

}  // namespace

double ColourScale::place(double value) const {
  if (!logarithmic) return (value - low) / (high - low);
  return std::log(std::max(value, 1e-300) / low) / std::log(high / low);
}

std::vector<double> compute_ticks(const ColourScale& scale, int n) {
  if (!scale.logarithmic) return linear_ticks(scale.low, scale.high, n);
  const auto ticks = logarithmic_ticks(scale.low, scale.high, n);
  return ticks.size() >= 2 ? ticks : linear_ticks(scale.low, scale.high, n);
}

void draw_colour_bar(ImageRgb8& image, const ColourScale& scale, const ColourMap& map) {
  const int letter = std::max(1, image.height / 360), margin = 8 * letter;
  const int bar_width = 9 * letter, bar_height = image.height * 6 / 10;
  const int top = image.height / 5, bottom = top + bar_height;
  // Room for the longest number to the right of the bar.
  const std::vector<double> ticks = compute_ticks(scale, 6);
  int widest = 0;
  for (const double tick : ticks)
    widest = std::max(widest, text_width(tick_text(tick, scale.high - scale.low), letter));
  const int right = image.width - margin - widest - 5 * letter, left = right - bar_width;
  fill_rectangle(image, left - letter, top - letter, right + letter, bottom + letter, ink);
  for (int y = top; y < bottom; ++y) {
    const float t = 1.0f - (static_cast<float>(y - top) + 0.5f) / static_cast<float>(bar_height);
    fill_rectangle(image, left, y, right, y + 1, quantize_srgb(map(t), 0.0f));
  }
  for (const double tick : ticks) {
    const int y = bottom - static_cast<int>(std::lround(scale.place(tick) * bar_height));
    fill_rectangle(image, right + letter, y - letter / 2, right + 3 * letter,
                   y - letter / 2 + std::max(1, letter / 2 + 1), ink);
    draw_text(image, right + 5 * letter, y - text_height(letter) / 2, tick_text(tick, scale.high - scale.low), letter,
              ink);
  }
  const int label = text_width(scale.label, letter);
  draw_text(image, std::min(left, image.width - margin - label), top - 3 * text_height(letter), scale.label, letter,
            ink);
}

}  // namespace smelt
