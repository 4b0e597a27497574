#include "render/black_body.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace smelt {

namespace {

// Exact in the SI of 2019.
constexpr double planck_constant = 6.62607015e-34;   // [J s]
constexpr double light_speed = 299792458.0;          // [m/s]
constexpr double boltzmann_constant = 1.380649e-23;  // [J/K]

constexpr double coldest = 500.0, hottest = 20000.0;
constexpr int n_entries = 400;

/// Lobe exp(-t^2/2) with another width on either side of its peak [nm].
double lobe(double nanometres, double peak, double per_width_below, double per_width_above) {
  const double t = (nanometres - peak) * (nanometres < peak ? per_width_below : per_width_above);
  return std::exp(-0.5 * t * t);
}

/// Where entry k of the table stands.
double inverse_temperature(int k) {
  return 1.0 / coldest + (1.0 / hottest - 1.0 / coldest) * k / (n_entries - 1);
}

/// Rec. 709 colour of the same luminance, without negative channels.
Vec3 into_gamut(const Vec3& rgb) {
  const Vec3 weights(0.2126, 0.7152, 0.0722);
  const Vec3 inside = rgb.cwiseMax(0.0);
  return inside * (weights.dot(rgb) / weights.dot(inside));
}

}  // namespace

double planck_radiance(double wavelength, double temperature) {
  const double first = 2.0 * planck_constant * light_speed * light_speed / std::pow(wavelength, 5.0);
  return first / std::expm1(planck_constant * light_speed / (wavelength * boltzmann_constant * temperature));
}

Vec3 cie_matching(double wavelength) {
  const double nm = wavelength * 1e9;
  const double x = 1.056 * lobe(nm, 599.8, 0.0264, 0.0323) + 0.362 * lobe(nm, 442.0, 0.0624, 0.0374) -
                   0.065 * lobe(nm, 501.1, 0.0490, 0.0382);
  const double y = 0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322);
  const double z = 1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725);
  // In the deep red, where glowing rock has its light, x is to y as 2.77 to 1.
  const double t = std::clamp((nm - 640.0) / 50.0, 0.0, 1.0), red = t * t * (3.0 - 2.0 * t);
  return {(1.0 - red) * x + red * 2.77 * y, y, z};
}

Vec3 black_body_xyz(double temperature) {
  Vec3 sum = Vec3::Zero();
  constexpr double step = 1e-9;
  for (int nm = 360; nm < 830; ++nm) {
    const double wavelength = (nm + 0.5) * step;
    sum += planck_radiance(wavelength, temperature) * cie_matching(wavelength);
  }
  return 683.0 * step * sum;
}

Vec3 rgb_from_xyz(const Vec3& xyz) {
  Mat3 m;
  m << 3.2406, -1.5372, -0.4986, -0.9689, 1.8758, 0.0415, 0.0557, -0.2040, 1.0570;
  return m * xyz;
}

BlackBodyTable::BlackBodyTable() {
  for (int k = 0; k < n_entries; ++k) {
    const Vec3 xyz = black_body_xyz(1.0 / inverse_temperature(k));
    entries_.push_back({static_cast<float>(std::log(xyz[1])), into_gamut(rgb_from_xyz(xyz) / xyz[1]).cast<float>()});
  }
}

Vec3f BlackBodyTable::operator()(float temperature) const {
  constexpr auto lowest = static_cast<float>(coldest), highest = static_cast<float>(hottest);
  if (!(temperature >= lowest)) return Vec3f::Zero();
  const float place = (1.0f / std::min(temperature, highest) - 1.0f / lowest) / (1.0f / highest - 1.0f / lowest) *
                      static_cast<float>(n_entries - 1);
  const int k = std::clamp(static_cast<int>(place), 0, n_entries - 2);
  const float t = place - static_cast<float>(k);
  const Entry &a = entries_[static_cast<std::size_t>(k)], &b = entries_[static_cast<std::size_t>(k + 1)];
  return (a.colour + (b.colour - a.colour) * t) * std::exp(a.log_luminance + (b.log_luminance - a.log_luminance) * t);
}

}  // namespace smelt
