#pragma once
// Solids for tests of rigid bodies.

#include "core/geometry/swept_sphere.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace smelt {

/// A regular polygon, counter-clockwise: its outside is out.
inline std::vector<Simplex<2>> make_polygon(int n, double radius, const Vec<2>& centre) {
  std::vector<Simplex<2>> segments;
  const auto corner = [&](int k) {
    const double angle = 2.0 * std::numbers::pi * (k % n) / n;
    return Vec<2>(centre + radius * Vec<2>(std::cos(angle), std::sin(angle)));
  };
  for (int k = 0; k < n; ++k) segments.push_back({corner(k), corner(k + 1)});
  return segments;
}

/// A rectangle, counter-clockwise, its sides cut in `n` each.
inline std::vector<Simplex<2>> make_rectangle(const Vec<2>& lower, const Vec<2>& upper, int n = 1) {
  const std::vector<Vec<2>> corners{lower, {upper[0], lower[1]}, upper, {lower[0], upper[1]}};
  std::vector<Simplex<2>> segments;
  for (std::size_t c = 0; c < 4; ++c)
    for (int k = 0; k < n; ++k) {
      const auto at = [&](int i) {
        return i == n ? corners[(c + 1) % 4] : Vec<2>(corners[c] + i * (corners[(c + 1) % 4] - corners[c]) / n);
      };
      segments.push_back({at(k), at(k + 1)});
    }
  return segments;
}

/// A ball: an octahedron's faces, each cut in n^2, on the sphere.
inline std::vector<Simplex<3>> make_sphere(int n, double radius, const Vec3& centre) {
  std::vector<Simplex<3>> facets;
  for (int octant = 0; octant < 8; ++octant) {
    const Vec3 x((octant & 1) ? -1 : 1, 0, 0), y(0, (octant & 2) ? -1 : 1, 0), z(0, 0, (octant & 4) ? -1 : 1);
    const bool flip = x[0] * y[1] * z[2] < 0.0;
    const auto at = [&](int i, int j) {
      return Vec3(centre + radius * ((n - i - j) * x + i * y + j * z).normalized());
    };
    const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      facets.push_back(flip ? Simplex<3>{a, c, b} : Simplex<3>{a, b, c});
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n - i; ++j) {
        add(at(i, j), at(i + 1, j), at(i, j + 1));
        if (j < n - i - 1) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
  }
  return facets;
}

/// A box [lower, upper], two triangles a side.
inline std::vector<Simplex<3>> make_brick(const Vec3& lower, const Vec3& upper) {
  std::vector<Simplex<3>> facets;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true}) {
      const auto corner = [&](bool u, bool v) {
        Vec3 x;
        x[axis] = high ? upper[axis] : lower[axis];
        x[(axis + 1) % 3] = u ? upper[(axis + 1) % 3] : lower[(axis + 1) % 3];
        x[(axis + 2) % 3] = v ? upper[(axis + 2) % 3] : lower[(axis + 2) % 3];
        return x;
      };
      Simplex<3> a{corner(false, false), corner(true, false), corner(true, true)},
          b{corner(false, false), corner(true, true), corner(false, true)};
      if (!high) {
        std::swap(a[1], a[2]);
        std::swap(b[1], b[2]);
      }
      facets.push_back(a);
      facets.push_back(b);
    }
  return facets;
}

}  // namespace smelt
