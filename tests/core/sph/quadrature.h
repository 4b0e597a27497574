#pragma once
// What the tests of wall integrals integrate, and how.

#include "core/geometry/swept_sphere.h"
#include "core/sph/kernel.h"

#include <Eigen/Geometry>

#include <array>
#include <random>
#include <vector>

namespace smelt {

inline constexpr KernelType all_kernels[] = {KernelType::cubic_spline, KernelType::quintic_spline,
                                             KernelType::quadratic};

/// Adds int f over [begin, end] to `sum`: composite Gauss-Legendre quadrature, three points a panel.
template <typename Sum, typename F>
Sum integrate_interval(double begin, double end, int n_panels, Sum sum, const F& f) {
  constexpr double node[] = {-0.77459666924148337704, 0.0, 0.77459666924148337704};
  constexpr double weight[] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const double width = (end - begin) / n_panels;
  for (int panel = 0; panel < n_panels; ++panel)
    for (int k = 0; k < 3; ++k) sum += weight[k] * width * f(begin + (panel + 0.5 + 0.5 * node[k]) * width);
  return sum;
}

template <int Dim>
struct Facet {
  Simplex<Dim> corners;
  Vec<Dim> normal;
};

/// A random tetrahedron or triangle with normals outward.
template <int Dim>
std::vector<Facet<Dim>> random_body(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  std::array<Vec<Dim>, Dim + 1> corners;
  for (auto& x : corners) x = Vec<Dim>::NullaryExpr([&] { return uniform(random); });
  std::vector<Facet<Dim>> facets;
  for (int opposite = 0; opposite <= Dim; ++opposite) {
    Facet<Dim> facet;
    for (int k = 0; k < Dim; ++k) facet.corners[k] = corners[(opposite + 1 + k) % (Dim + 1)];
    const Vec<Dim> a = facet.corners[1] - facet.corners[0];
    if constexpr (Dim == 2) {
      facet.normal = Vec<2>(a[1], -a[0]).normalized();
    } else {
      facet.normal = a.cross(facet.corners[2] - facet.corners[0]).normalized();
    }
    if (facet.normal.dot(corners[opposite] - facet.corners[0]) > 0.0) facet.normal = -facet.normal;
    facets.push_back(facet);
  }
  return facets;
}

}  // namespace smelt
