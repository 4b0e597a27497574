#pragma once
// From scene radiance to display bytes.

#include "core/geometry/vec.h"

#include <array>
#include <cstdint>

namespace smelt {

/// Linear scene RGB to linear display RGB in [0, 1] by the Khronos PBR Neutral curve (Khronos 2024) without its toe,
/// which would crush the shadows: colours below 0.8 come out as they went in; brighter ones are compressed and bleach.
/// Negative input counts as zero.
Vec3f tone_map_neutral(const Vec3f& colour);

/// The same shoulder on each channel by itself, as film has it: what glows red turns orange, yellow and white as it
/// grows brighter.
Vec3f tone_map_film(const Vec3f& colour);

/// The sRGB transfer curve (IEC 61966-2-1), [0, 1] to [0, 1].
float srgb_from_linear(float value);
/// Its inverse.
float linear_from_srgb(float value);

/// sRGB bytes of a linear display colour in [0, 1]. `dither` in [-1, 1] shifts by that many half steps before rounding,
/// against banding in gradients.
std::array<std::uint8_t, 3> quantize_srgb(const Vec3f& colour, float dither);

/// The same with 16 bits, rounded.
std::array<std::uint16_t, 3> quantize_srgb16(const Vec3f& colour);

}  // namespace smelt
