// Integrals over one facet at a time; tests/core/sph/wall_integrals_test.cpp has whole solids.

#include "core/sph/wall_integrals.h"
#include "tests/core/sph/quadrature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>
#include <vector>

namespace smelt {
namespace {

constexpr double pi = std::numbers::pi;

/// The angle that the facet subtends at the origin; negative behind it.
double subtended(const Facet<2>& facet) {
  const auto& [a, b] = facet.corners;
  return std::copysign(std::acos(a.dot(b) / (a.norm() * b.norm())), -facet.normal.dot(a));
}
double subtended(const Facet<3>& facet) {
  const auto& [a, b, c] = facet.corners;
  const double ra = a.norm(), rb = b.norm(), rc = c.norm();
  const double angle =
      2.0 * std::atan2(std::abs(a.dot(b.cross(c))), ra * rb * rc + a.dot(b) * rc + a.dot(c) * rb + b.dot(c) * ra);
  return std::copysign(angle, -facet.normal.dot(a));
}

/// Quadrature of W over the facet line by line, cut where a line passes a knot of the kernel. `solid` goes ray by ray
/// through each patch: int distance N(r)/r^d dS, of which the singular part is N(0) times the angle.
template <int Dim>
class FacetQuadrature {
 public:
  FacetQuadrature(double h, KernelType type) : kernel_(h, type), tail_(n_radii + 1, 0.0) {
    for (int k = n_radii; k-- > 0;) {
      const double r = (k + 0.5) * dr();
      tail_[k] = tail_[k + 1] + dr() * std::pow(r, Dim - 1) * kernel_.value(r);
    }
  }

  /// Seen from the origin. `n_lines` panels of lines, three lines a panel.
  FacetIntegrals<Dim> integrate(const Facet<Dim>& facet, int n_lines) const {
    const Vec<Dim> a = facet.corners[0], u = facet.corners[1] - a;
    const double distance = -facet.normal.dot(a);
    Values values = Values::Zero();
    if constexpr (Dim == 2) {
      values = u.norm() * along_line(a, u, distance);
    } else {
      // Duffy's map: x = a + s (u + t (v - u)).
      const Vec3 v = facet.corners[2] - a;
      values = u.cross(v).norm() * integrate_interval(0.0, 1.0, n_lines, values, [&](double s) -> Values {
                 return s * along_line(a + s * u, s * (v - u), distance);
               });
    }
    return {values[0], values.template segment<Dim>(1), values[Dim + 1] + tail_[0] * subtended(facet)};
  }

 private:
  static constexpr int n_radii = 100000;
  using Values = Eigen::Matrix<double, Dim + 2, 1>;  // area, first, solid

  double dr() const { return kernel_.support_radius() / n_radii; }

  Values integrand(const Vec<Dim>& y, double distance) const {
    const double r = y.norm(), node = r / dr();
    const int k = static_cast<int>(std::min(node, n_radii - 1.0));
    const double w = kernel_.value(r), tail = node < n_radii ? tail_[k] + (node - k) * (tail_[k + 1] - tail_[k]) : 0.0;
    Values values;
    values << w, w * y, distance / std::pow(r, Dim) * (tail - tail_[0]);
    return values;
  }

  /// The mean of the integrand over origin + t direction, 0 <= t <= 1.
  Values along_line(const Vec<Dim>& origin, const Vec<Dim>& direction, double distance) const {
    const double length2 = direction.squaredNorm(), foot = -origin.dot(direction) / length2;
    const double b2 = (origin + foot * direction).squaredNorm();
    std::vector<double> cuts = {0.0, 1.0, std::clamp(foot, 0.0, 1.0)};
    for (double half = std::sqrt(b2 / length2); half < 10.0;
         half *= 4.0)  // finer where the line passes the origin closely
      for (const double side : {-1.0, 1.0}) cuts.push_back(std::clamp(foot + side * half, 0.0, 1.0));
    for (int knot = 1; knot * kernel_.smoothing_length() <= 1.001 * kernel_.support_radius(); ++knot) {
      const double half2 = (std::pow(knot * kernel_.smoothing_length(), 2) - b2) / length2;
      if (half2 <= 0.0) continue;
      for (const double side : {-1.0, 1.0}) cuts.push_back(std::clamp(foot + side * std::sqrt(half2), 0.0, 1.0));
    }
    std::ranges::sort(cuts);
    Values sum = Values::Zero();
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k)
      if (cuts[k] < cuts[k + 1])
        sum = integrate_interval(cuts[k], cuts[k + 1], 8, sum,
                                 [&](double t) { return integrand(origin + t * direction, distance); });
    return sum;
  }

  Kernel<Dim> kernel_;
  std::vector<double> tail_;  // N of the header by the midpoint rule, at the ends of its intervals
};

template <int Dim>
void expect_facets_match_quadrature() {
  for (const KernelType type : all_kernels) {
    const double h = 0.7;
    const WallKernel<Dim> kernel(h, type);
    const FacetQuadrature<Dim> oracle(h, type);
    std::mt19937 random(23);
    for (int trial = 0; trial < 12; ++trial) {
      const auto facet = random_body<Dim>(random, trial % 3 == 0 ? 2.5 : 0.8)[0];
      const auto got = integrate_facet<Dim>(kernel, facet.corners, facet.normal, Vec<Dim>::Zero());
      const auto want = oracle.integrate(facet, 200);
      SCOPED_TRACE(fmt::format("{}D kernel {} trial {}", Dim, static_cast<int>(type), trial));
      EXPECT_NEAR(got.area * h, want.area * h, 1e-9);
      EXPECT_NEAR(got.solid, want.solid, 1e-9);
      EXPECT_LE((got.first - want.first).norm(), 1e-9);
    }
  }
}
TEST(FacetIntegrals, RandomFacetsMatchQuadrature) {
  expect_facets_match_quadrature<2>();
  expect_facets_match_quadrature<3>();
}

template <int Dim>
void expect_near(const FacetIntegrals<Dim>& got, const FacetIntegrals<Dim>& want, double tolerance) {
  EXPECT_NEAR(got.area, want.area, tolerance);
  EXPECT_NEAR(got.solid, want.solid, tolerance);
  EXPECT_LE((got.first - want.first).norm(), tolerance)
      << got.first.transpose() << " against " << want.first.transpose();
}

// Splits a triangle, with the foot of the point inside, on an edge, on a corner, and far away; in front, in the plane,
// behind.
TEST(FacetIntegrals, ATriangleIsTheSumOfItsParts) {
  const Simplex<3> triangle = {Vec3(-0.9, -0.7, 0.0), Vec3(1.3, -0.4, 0.0), Vec3(0.2, 1.1, 0.0)};
  const Vec3 normal = Vec3::UnitZ();
  const std::array<Vec3, 3> off_the_edges = {Vec3(0.1, 0.05, 0.0), Vec3(-0.3, 0.2, 0.0), Vec3(0.9, 0.8, 0.0)};
  const std::array<Vec3, 2> on_the_edges = {0.5 * (triangle[0] + triangle[1]), triangle[2]};
  const auto expect_sum_of_parts = [&](const WallKernel<3>& kernel, const Vec3& split, const Vec3& point) {
    FacetIntegrals<3> sum;
    for (int k = 0; k < 3; ++k) {
      // A split outside of the triangle gives a part of negative area, whose corners go round the other way.
      const Simplex<3> part = {triangle[k], triangle[(k + 1) % 3], split};
      const double sign = (part[1] - part[0]).cross(part[2] - part[0]).dot(normal) < 0.0 ? -1.0 : 1.0;
      const auto f = integrate_facet<3>(kernel, part, normal, point);
      sum.area += sign * f.area;
      sum.first += sign * f.first;
      sum.solid += sign * f.solid;
    }
    SCOPED_TRACE(fmt::format("point {} {} {} split {} {}", point[0], point[1], point[2], split[0], split[1]));
    expect_near(sum, integrate_facet<3>(kernel, triangle, normal, point), 1e-12);
  };
  for (const KernelType type : all_kernels) {
    const WallKernel<3> kernel(0.7, type);
    for (const double d : {0.0, 1e-15, 1e-9, 0.2, 0.8, -0.3, -1e-9})
      for (const Vec3& split : off_the_edges) {
        for (const Vec3& foot : off_the_edges) expect_sum_of_parts(kernel, split, foot + d * normal);
        for (const Vec3& foot : on_the_edges) expect_sum_of_parts(kernel, split, foot + d * normal);
      }
    // A split on an edge moves it by rounding: near the plane that turns the edge as the point sees it.
    for (const double d : {0.2, 0.8, -0.3})
      for (const Vec3& split : on_the_edges) {
        for (const Vec3& foot : off_the_edges) expect_sum_of_parts(kernel, split, foot + d * normal);
        for (const Vec3& foot : on_the_edges) expect_sum_of_parts(kernel, split, foot + d * normal);
      }
  }
}

TEST(FacetIntegrals, ASegmentIsTheSumOfItsParts) {
  for (const KernelType type : all_kernels) {
    const WallKernel<2> kernel(0.7, type);
    const Vec<2> a(-0.9, 0.0), b(1.3, 0.0), normal(0.0, 1.0);
    for (const double split : {-0.5, 0.0, 0.4})
      for (const double d : {0.0, 1e-9, 0.2, 0.8, -0.3}) {
        const Vec<2> point(0.0, d), middle(split, 0.0);
        auto sum = integrate_facet<2>(kernel, {a, middle}, normal, point);
        const auto other = integrate_facet<2>(kernel, {b, middle}, normal, point);
        sum.area += other.area, sum.first += other.first, sum.solid += other.solid;
        expect_near(sum, integrate_facet<2>(kernel, {a, b}, normal, point), 1e-13);
      }
  }
}

// Corners and point on one lattice: the foot falls on edges, their lines and corners, and the point into the facet's
// plane, all the time.
TEST(FacetIntegrals, AreaAndFirstMomentAreContinuousEverywhere) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> lattice(-2, 2);
  const auto corner = [&] { return Vec3(0.3 * lattice(random), 0.3 * lattice(random), 0.3 * lattice(random)); };
  int n_in_plane = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Simplex<3> triangle = {corner(), corner(), corner()};
    const Vec3 cross = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]), point = corner();
    if (cross.norm() < 1e-6) continue;
    const Vec3 normal = cross.normalized();
    n_in_plane += std::abs(normal.dot(point - triangle[0])) < 1e-12;
    for (const KernelType type : all_kernels) {
      const WallKernel<3> kernel(0.7, type);
      const auto here = integrate_facet<3>(kernel, triangle, normal, point);
      const auto nearby = integrate_facet<3>(kernel, triangle, normal, point + Vec3(3e-8, -2e-8, 1e-8));
      EXPECT_NEAR(here.area, nearby.area, 1e-6) << "trial " << trial;
      EXPECT_LE((here.first - nearby.first).norm(), 1e-6) << "trial " << trial;
      EXPECT_LE(std::abs(here.solid), 0.5 + 1e-13) << "trial " << trial;
    }
  }
  EXPECT_GT(n_in_plane, 100);
}

// An infinite wall: half of space in its plane, the kernel's own marginal anywhere else; the two sides are mirror
// images.
TEST(FacetIntegrals, AWholePlaneFromTheFrontAndFromBehind) {
  for (const KernelType type : all_kernels) {
    const double h = 0.01;
    const WallKernel<3> kernel(h, type);
    const Simplex<3> wall = {Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(0, 1, 0)};
    EXPECT_NEAR(integrate_facet<3>(kernel, wall, Vec3::UnitZ(), Vec3::Zero()).solid, 0.5, 1e-13);
    for (const double d : {0.3 * h, 1.1 * h, 1.9 * h}) {
      const auto front = integrate_facet<3>(kernel, wall, Vec3::UnitZ(), Vec3(0, 0, d));
      const auto behind = integrate_facet<3>(kernel, wall, Vec3::UnitZ(), Vec3(0, 0, -d));
      const double marginal = integrate_interval(d, kernel.support_radius(), 2000, 0.0,
                                                 [&](double r) { return 2.0 * pi * r * Kernel<3>(h, type).value(r); });
      EXPECT_NEAR(front.area * h, marginal * h, 1e-10);
      EXPECT_NEAR(front.area, behind.area, 1e-12 / h);
      EXPECT_NEAR(front.solid, -behind.solid, 1e-14);
      EXPECT_NEAR(front.first[2], -d * front.area, 1e-13);
    }
  }
}

TEST(FacetIntegrals, FacetsWithoutExtentAddNothing) {
  const WallKernel<3> kernel(0.7);
  const Vec3 a(0.1, 0.2, -0.1), b(0.3, -0.1, 0.2);
  for (const auto& sliver : {Simplex<3>{a, a, a}, Simplex<3>{a, b, a}, Simplex<3>{a, b, 0.3 * a + 0.7 * b},
                             Simplex<3>{a, 3.0 * b - 2.0 * a, b}})
    for (const Vec3& normal : {Vec3(Vec3::UnitX()), Vec3((b - a).unitOrthogonal())}) {
      const auto f = integrate_facet<3>(kernel, sliver, normal, Vec3(0.15, 0.1, 0.0));
      EXPECT_EQ(f.area, 0.0);
      EXPECT_EQ(f.solid, 0.0);
      EXPECT_EQ(f.first, Vec3(Vec3::Zero()));
    }
  const auto f = integrate_facet<2>(WallKernel<2>(0.7), {a.head<2>(), a.head<2>()}, Vec<2>(0, 1), Vec<2>(0.1, 0.1));
  EXPECT_EQ(f.area, 0.0);
  EXPECT_EQ(f.solid, 0.0);
}

// The box around the facet touches the support, the facet itself does not.
TEST(FacetIntegrals, FacetsOutsideTheSupportAddNothing) {
  const WallKernel<3> kernel(0.5);
  const auto f =
      integrate_facet<3>(kernel, {Vec3(2, 0, 0.1), Vec3(0, 2, 0.1), Vec3(2, 2, 0.1)}, Vec3::UnitZ(), Vec3::Zero());
  EXPECT_EQ(f.area, 0.0);
  EXPECT_EQ(f.solid, 0.0);
  EXPECT_EQ(f.first, Vec3(Vec3::Zero()));
  const auto g =
      integrate_facet<2>(WallKernel<2>(0.5), {Vec<2>(2, 0), Vec<2>(0, 2)}, Vec<2>(1, 1).normalized(), Vec<2>(0, 0));
  EXPECT_EQ(g.area, 0.0);
  EXPECT_EQ(g.solid, 0.0);
}

}  // namespace
}  // namespace smelt
