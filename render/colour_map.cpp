#include "render/colour_map.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace smelt {

namespace {

Mat3 matrix(std::initializer_list<double> rows) {
  Mat3 m;
  auto value = rows.begin();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = *value++;
  return m;
}

const Mat3 cones_from_rgb = matrix({0.4122214708, 0.5363325363, 0.0514459929, 0.2119034982, 0.6806995451, 0.1073969566,
                                    0.0883024619, 0.2817188376, 0.6299787005});
const Mat3 lab_from_cones = matrix({0.2104542553, 0.7936177850, -0.0040720468, 1.9779984951, -2.4285922050,
                                    0.4505937099, 0.0259040371, 0.7827717662, -0.8086757660});

bool displayable(const Vec3& rgb) {
  return rgb.minCoeff() >= 0.0 && rgb.maxCoeff() <= 1.0;
}

/// The path at s in [0, 1].
Vec3 path_lab(double s) {
  const double lightness = 0.25 + 0.68 * s, hue = (305.0 - 200.0 * s) * std::numbers::pi / 180.0;
  const auto at = [&](double chroma) { return Vec3(lightness, chroma * std::cos(hue), chroma * std::sin(hue)); };
  // The most colourful that can be shown, up to a limit, by bisection; a little less, so that the path bends gently.
  double low = 0.0, high = 0.14;
  if (displayable(rgb_from_oklab(at(high)))) low = high;
  for (int i = 0; i < 40 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    (displayable(rgb_from_oklab(at(middle))) ? low : high) = middle;
  }
  return at(0.94 * low);
}

}  // namespace

Vec3 rgb_from_oklab(const Vec3& lab) {
  const Vec3 roots = lab_from_cones.inverse() * lab;
  return cones_from_rgb.inverse() * roots.cwiseProduct(roots).cwiseProduct(roots);
}

Vec3 oklab_from_rgb(const Vec3& rgb) {
  const Vec3 cones = cones_from_rgb * rgb;
  return lab_from_cones * Vec3(std::cbrt(cones[0]), std::cbrt(cones[1]), std::cbrt(cones[2]));
}

ColourMap::ColourMap() {
  constexpr int n_fine = 4096;
  std::vector<Vec3> path;
  std::vector<double> length{0.0};
  for (int k = 0; k <= n_fine; ++k) {
    path.push_back(path_lab(static_cast<double>(k) / n_fine));
    if (k > 0)
      length.push_back(length.back() +
                       (path[static_cast<std::size_t>(k)] - path[static_cast<std::size_t>(k - 1)]).norm());
  }
  for (int k = 0; k < n_; ++k) {
    const double wanted = length.back() * k / (n_ - 1);
    const auto above = std::clamp<std::size_t>(
        static_cast<std::size_t>(std::lower_bound(length.begin(), length.end(), wanted) - length.begin()), 1, n_fine);
    const double t = (wanted - length[above - 1]) / (length[above] - length[above - 1]);
    const Vec3 lab = path[above - 1] + t * (path[above] - path[above - 1]);
    colours_[static_cast<std::size_t>(k)] = rgb_from_oklab(lab).cwiseMax(0.0).cwiseMin(1.0).cast<float>();
  }
}

Vec3f ColourMap::operator()(float t) const {
  const float place = std::clamp(t, 0.0f, 1.0f) * (n_ - 1);
  const int k = std::min(static_cast<int>(place), n_ - 2);
  const float f = place - static_cast<float>(k);
  return colours_[static_cast<std::size_t>(k)] * (1.0f - f) + colours_[static_cast<std::size_t>(k + 1)] * f;
}

}  // namespace smelt
