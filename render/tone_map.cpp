#include "render/tone_map.h"

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

constexpr float start = 0.8f;         ///< below, colours are shown as they are
constexpr float room = 1.0f - start;  ///< for everything brighter

float shoulder(float x) {
  return x < start ? x : 1.0f - room * room / (x + room - start);
}

}  // namespace

Vec3f tone_map_film(const Vec3f& colour) {
  const Vec3f c = colour.cwiseMax(0.0f);
  return {shoulder(c.x()), shoulder(c.y()), shoulder(c.z())};
}

Vec3f tone_map_neutral(const Vec3f& colour) {
  constexpr float desaturation = 0.15f;
  const Vec3f c = colour.cwiseMax(0.0f);
  const float peak = c.maxCoeff();
  if (peak < start) return c;
  const float new_peak = shoulder(peak);
  const float keep = 1.0f / (desaturation * (peak - new_peak) + 1.0f);
  return (c * (new_peak / peak * keep) + Vec3f::Constant(new_peak * (1.0f - keep))).cwiseMin(1.0f);
}

float srgb_from_linear(float value) {
  return value <= 0.0031308f ? 12.92f * value : 1.055f * std::pow(value, 1.0f / 2.4f) - 0.055f;
}

float linear_from_srgb(float value) {
  return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}

std::array<std::uint8_t, 3> quantize_srgb(const Vec3f& colour, float dither) {
  std::array<std::uint8_t, 3> bytes{};
  for (int i = 0; i < 3; ++i) {
    const float level = 255.0f * srgb_from_linear(std::clamp(colour[i], 0.0f, 1.0f)) + 0.5f * dither;
    bytes[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::clamp(level + 0.5f, 0.0f, 255.0f));
  }
  return bytes;
}

std::array<std::uint16_t, 3> quantize_srgb16(const Vec3f& colour) {
  std::array<std::uint16_t, 3> values{};
  for (int i = 0; i < 3; ++i)
    values[static_cast<std::size_t>(i)] =
        static_cast<std::uint16_t>(65535.0f * srgb_from_linear(std::clamp(colour[i], 0.0f, 1.0f)) + 0.5f);
  return values;
}

}  // namespace smelt
