#pragma once
// A picture in the making, in parts, linear and unclamped.

#include "core/geometry/vec.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace smelt {

/// One number per pixel, row-major from the top left.
using Plane = std::vector<float>;
/// Three of them: red, green, blue or x, y, z.
using Plane3 = std::array<Plane, 3>;

inline Vec3f read_pixel(const Plane3& planes, std::size_t i) {
  return {planes[0][i], planes[1][i], planes[2][i]};
}

inline void write_pixel(Plane3& planes, std::size_t i, const Vec3f& value) {
  for (int c = 0; c < 3; ++c) planes[static_cast<std::size_t>(c)][i] = value[c];
}

/// What a compositor asks for besides the picture: means over the samples of each pixel, of temperature, depth and
/// position over those that have one.
struct FilmLayers {
  Plane alpha;        ///< share of the pixel in front of the backdrop
  Plane depth;        ///< along the view [m]; 0 where nothing is
  Plane temperature;  ///< of the skin [K]; 0 where there is none
  Plane3 position;    ///< relative to the eye [m]; 0 where nothing is
  Plane3 velocity;    ///< [m/s]
  Plane3 colour;      ///< albedo, or reflectance of metals
};

/// Means over the samples of each pixel. The picture is albedo * light + specular + emission.
struct Film {
  int width = 0;
  int height = 0;
  Plane3 light;  ///< diffuse light, weighted by the samples' albedo: the radiance of a white surface
  Plane3 albedo;
  Plane3 specular;          ///< mirrored by the coat
  Plane3 emission;          ///< and backdrop
  Plane3 normal;            ///< not unit where surfaces share a pixel; zero where there is none
  Plane3 position;          ///< relative to the eye [m]
  Plane kind;               ///< mean over the samples of 0: floor or nothing, 1: fluid, 2: collider
  Plane light_variance;     ///< of the mean luminance of `light`
  Plane specular_variance;  ///< of the mean luminance of `specular`
  Plane clamped;            ///< luminance taken away by the firefly limit
  std::optional<FilmLayers> layers;

  Film(int film_width, int film_height, bool with_layers = false) : width(film_width), height(film_height) {
    const std::size_t n = size();
    for (Plane3* planes : {&light, &albedo, &specular, &emission, &normal, &position}) planes->fill(Plane(n, 0.0f));
    for (Plane* plane : {&kind, &light_variance, &specular_variance, &clamped}) plane->assign(n, 0.0f);
    if (!with_layers) return;
    layers.emplace();
    for (Plane* plane : {&layers->alpha, &layers->depth, &layers->temperature}) plane->assign(n, 0.0f);
    for (Plane3* planes : {&layers->position, &layers->velocity, &layers->colour}) planes->fill(Plane(n, 0.0f));
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  std::size_t size() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

/// Bytes that rendering needs per pixel: the film and the filter's copies of it.
inline constexpr std::size_t film_bytes_per_pixel = sizeof(float) * (22 + 12 + 10);

/// Relative luminance of linear sRGB (Rec. 709).
inline float luminance(const Vec3f& c) {
  return 0.2126f * c.x() + 0.7152f * c.y() + 0.0722f * c.z();
}

}  // namespace smelt
