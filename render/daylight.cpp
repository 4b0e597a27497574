#include "render/daylight.h"

#include "render/sampling.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace smelt {

namespace {

// Lengths in metres, scattering coefficients at sea level in 1/m.
constexpr double ground_radius = 6.360e6, air_radius = 6.420e6;
constexpr double air_scale = 8000.0, aerosol_scale = 1200.0;
constexpr double aerosol_scattering = 4e-6, forward_bias = 0.76, ground_albedo = 0.15;
const Vec3 air_scattering(5.8e-6, 13.5e-6, 33.1e-6);
/// Of the sun outside the atmosphere, in units of a white surface's radiance times pi.
constexpr double irradiance = 1.2 * std::numbers::pi;
constexpr int n_view_steps = 24, n_sun_steps = 8;

/// Air and aerosols along a way, as lengths at sea level's density.
struct Column {
  double air = 0.0, aerosol = 0.0;
};

Vec3 transmittance(const Column& c, double haze) {
  const Vec3 depth = air_scattering * c.air + Vec3::Constant(1.1 * haze * aerosol_scattering * c.aerosol);
  return (-depth.array()).exp();
}

/// Distance from `x` (relative to the middle of the earth) along `d` to a sphere that x is inside of.
double leave_sphere(const Vec3& x, const Vec3& d, double radius) {
  const double b = x.dot(d);
  return -b + std::sqrt(std::max(0.0, b * b - x.squaredNorm() + radius * radius));
}

bool meets_ground(const Vec3& x, const Vec3& d) {
  const double b = x.dot(d);
  return b < 0.0 && x.squaredNorm() - b * b < ground_radius * ground_radius;
}

void add_density(const Vec3& x, double length, Column& c) {
  const double height = std::max(0.0, x.norm() - ground_radius);
  c.air += length * std::exp(-height / air_scale);
  c.aerosol += length * std::exp(-height / aerosol_scale);
}

/// Between `x` and the sun; nothing where the earth is in between.
std::optional<Column> column_to_sun(const Vec3& x, const Vec3& to_sun) {
  if (meets_ground(x, to_sun)) return std::nullopt;
  Column c;
  const double step = leave_sphere(x, to_sun, air_radius) / n_sun_steps;
  for (int k = 0; k < n_sun_steps; ++k) add_density(x + to_sun * ((k + 0.5) * step), step, c);
  return c;
}

const Vec3 observer(0.0, ground_radius + 100.0, 0.0);

Vec3 sky_toward(const Vec3& d, const Daylight& day) {
  const double cosine = d.dot(day.to_sun), g = forward_bias;
  const double air_phase = 3.0 / (16.0 * std::numbers::pi) * (1.0 + cosine * cosine);
  const double aerosol_phase = (1.0 - g * g) / (4.0 * std::numbers::pi * std::pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
  const double far = leave_sphere(observer, d, air_radius);
  Column before;
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < n_view_steps; ++k) {
    // Steps grow with distance, as the air thins: the k-th ends at far ((k + 1) / n)^2.
    const auto end = [&](int i) { return far * i * i / (n_view_steps * n_view_steps); };
    const double step = end(k + 1) - end(k);
    const Vec3 x = observer + d * (0.5 * (end(k) + end(k + 1)));
    Column here;
    add_density(x, step, here);
    const Column half{before.air + 0.5 * here.air, before.aerosol + 0.5 * here.aerosol};
    before.air += here.air;
    before.aerosol += here.aerosol;
    const auto sun = column_to_sun(x, day.to_sun);
    if (!sun) continue;
    const Vec3 light = transmittance({half.air + sun->air, half.aerosol + sun->aerosol}, day.haze);
    const Vec3 scattered = air_scattering * (air_phase * here.air) +
                           Vec3::Constant(day.haze * aerosol_scattering * aerosol_phase * here.aerosol);
    sum += irradiance * light.cwiseProduct(scattered);
  }
  return sum;
}

Vec3 sun_irradiance(const Daylight& day) {
  const auto column = column_to_sun(observer, day.to_sun);
  return column ? Vec3(irradiance * transmittance(*column, day.haze)) : Vec3::Zero();
}

Vec3 direction_of(int x, int y, int width, int height) {
  const double theta = std::numbers::pi * (y + 0.5) / height, phi = 2.0 * std::numbers::pi * ((x + 0.5) / width - 0.5);
  return {std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)};
}

}  // namespace

RadianceImage make_sky(const Daylight& day, int width, int height) {
  RadianceImage image{width, height, {}};
  image.pixels.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), Vec3f::Zero());
  const auto at = [&](int x, int y) -> Vec3f& {
    return image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  };
  const int horizon = height / 2;
  tbb::parallel_for(0, horizon, [&](int y) {
    for (int x = 0; x < width; ++x) at(x, y) = sky_toward(direction_of(x, y, width, height), day).cast<float>();
  });
  // The ground reflects what falls on it.
  Vec3 fallen = sun_irradiance(day) * std::max(0.0, day.to_sun.y());
  const double cell = 2.0 * std::numbers::pi / width * std::numbers::pi / height;
  for (int y = 0; y < horizon; ++y)
    for (int x = 0; x < width; ++x) {
      const double up = direction_of(x, y, width, height).y();
      fallen += at(x, y).cast<double>() * (up * std::sqrt(1.0 - up * up) * cell);
    }
  const Vec3f ground = (ground_albedo / std::numbers::pi * fallen).cast<float>();
  for (int y = horizon; y < height; ++y)
    for (int x = 0; x < width; ++x) at(x, y) = ground;
  return image;
}

Sun make_sun(const Daylight& day) {
  Sun sun;
  sun.direction = day.to_sun;
  const double half = std::sin(0.5 * sun.angular_radius_deg * std::numbers::pi / 180.0);
  const double solid_angle = 4.0 * std::numbers::pi * half * half;
  sun.radiance = (sun_irradiance(day) / solid_angle).cast<float>();
  return sun;
}

}  // namespace smelt
