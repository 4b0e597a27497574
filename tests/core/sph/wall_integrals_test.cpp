#include "core/sph/wall_integrals.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

namespace smelt {
namespace {

constexpr KernelType all_kernels[] = {KernelType::cubic_spline, KernelType::quintic_spline, KernelType::quadratic};
constexpr double pi = std::numbers::pi;

// ---- Oracles: composite Gauss-Legendre quadrature of the kernel itself, without any of the divergence theorem

/// Three points a panel.
template <typename Sum, typename F>
Sum integrate_interval(double begin, double end, int n_panels, Sum sum, const F& f) {
  constexpr double node[] = {-0.77459666924148337704, 0.0, 0.77459666924148337704};
  constexpr double weight[] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const double width = (end - begin) / n_panels;
  for (int panel = 0; panel < n_panels; ++panel)
    for (int k = 0; k < 3; ++k) sum += weight[k] * width * f(begin + (panel + 0.5 + 0.5 * node[k]) * width);
  return sum;
}

/// The integrals over a solid, seen from `point`.
template <int Dim>
struct SolidIntegrals {
  double volume = 0.0;                   ///< int W dV
  Vec<Dim> gradient = Vec<Dim>::Zero();  ///< int grad_i W dV [1/m]
  Mat<Dim> moment = Mat<Dim>::Zero();    ///< int y (x) grad_i W dV

  SolidIntegrals& operator+=(const SolidIntegrals& o) {
    volume += o.volume, gradient += o.gradient, moment += o.moment;
    return *this;
  }
  friend SolidIntegrals operator*(double s, SolidIntegrals o) {
    o.volume *= s, o.gradient *= s, o.moment *= s;
    return o;
  }
};

/// Over a box, cut to the kernel's support, and at the point, where a kernel may have a kink.
template <int Dim>
SolidIntegrals<Dim> integrate_box(const Kernel<Dim>& kernel, const Box<Dim>& box, const Vec<Dim>& point, int n_panels) {
  const double radius = kernel.support_radius();
  const Vec<Dim> lower = (box.lower - point).cwiseMax(-radius), upper = (box.upper - point).cwiseMin(radius);
  if ((lower.array() >= upper.array()).any()) return {};
  Vec<Dim> y;
  const std::function<SolidIntegrals<Dim>(int)> over_axis = [&](int axis) {
    if (axis == Dim) {
      const double r = y.norm();
      const Vec<Dim> gradient = -kernel.derivative(r) / r * y;
      return SolidIntegrals<Dim>{kernel.value(r), gradient, y * gradient.transpose()};
    }
    SolidIntegrals<Dim> sum;
    const double middle = std::clamp(0.0, lower[axis], upper[axis]);
    for (const auto& [begin, end] : {std::pair(lower[axis], middle), std::pair(middle, upper[axis])}) {
      if (begin == end) continue;
      const int n = 1 + static_cast<int>(n_panels * (end - begin) / (2.0 * radius));
      sum = integrate_interval(begin, end, n, sum, [&](double value) {
        y[axis] = value;
        return over_axis(axis + 1);
      });
    }
    return sum;
  };
  return over_axis(0);
}

template <int Dim>
struct Facet {
  Simplex<Dim> corners;
  Vec<Dim> normal;
};

/// The same from facets, by the divergence theorem.
template <int Dim>
SolidIntegrals<Dim> integrate_facets(const WallKernel<Dim>& kernel, const std::vector<Facet<Dim>>& facets,
                                     const Vec<Dim>& point) {
  SolidIntegrals<Dim> sum;
  for (const auto& facet : facets) {
    const auto f = integrate_facet<Dim>(kernel, facet.corners, facet.normal, point);
    sum += {f.solid, -f.area * facet.normal, f.solid * Mat<Dim>::Identity() - f.first * facet.normal.transpose()};
  }
  return sum;
}

/// The face of `box` across `axis` on its upper or lower side, normal outward. The corners go round as they come.
template <int Dim>
void append_face(const Box<Dim>& box, int axis, bool upper, std::vector<Facet<Dim>>& facets) {
  const Vec<Dim> normal = (upper ? 1.0 : -1.0) * Vec<Dim>::Unit(axis);
  Vec<Dim> a = box.lower, b = box.upper;
  a[axis] = b[axis] = upper ? box.upper[axis] : box.lower[axis];
  if constexpr (Dim == 1) {
    facets.push_back({{a}, normal});
  } else if constexpr (Dim == 2) {
    facets.push_back({{a, b}, normal});
  } else {
    const int u = (axis + 1) % 3;
    Vec3 c = a, e = b;
    c[u] = b[u], e[u] = a[u];
    facets.push_back({{a, c, b}, normal});
    facets.push_back({{a, b, e}, normal});
  }
}

template <int Dim>
std::vector<Facet<Dim>> surface_of(const Box<Dim>& box) {
  std::vector<Facet<Dim>> facets;
  for (int axis = 0; axis < Dim; ++axis)
    for (const bool upper : {false, true}) append_face(box, axis, upper, facets);
  return facets;
}

template <int Dim>
void expect_near(const SolidIntegrals<Dim>& got, const SolidIntegrals<Dim>& want, double h, double tolerance) {
  EXPECT_NEAR(got.volume, want.volume, tolerance);
  EXPECT_LE((got.gradient - want.gradient).norm() * h, tolerance)
      << got.gradient.transpose() << " against " << want.gradient.transpose();
  EXPECT_LE((got.moment - want.moment).norm(), tolerance) << got.moment << "\nagainst\n" << want.moment;
}

/// Panels and tolerance such that the oracle's error (kernels jump in their second or third derivative) stays below the
/// latter.
template <int Dim>
constexpr int n_panels = Dim == 1   ? 2000
                         : Dim == 2 ? 400
                                    : 24;
template <int Dim>
constexpr double oracle_tolerance = Dim == 1   ? 1e-9
                                    : Dim == 2 ? 2e-7
                                               : 2e-5;

TEST(WallIntegrals, TermsAddUpToTheKernel) {
  for (const KernelType type : all_kernels) {
    const WallKernel<2> wall(1.0, type);
    const Kernel<2> kernel(1.0, type);
    for (double q = 0.0; q < kernel.support_radius() + 0.2; q += 0.0371) {
      double sum = 0.0;
      for (const RadialTerm& term : wall.terms())
        for (std::size_t k = 0; q < term.radius && k < term.shape.size(); ++k) sum += term.shape[k] * std::pow(q, k);
      EXPECT_NEAR(sum, kernel.value(q), 1e-14) << "kernel " << static_cast<int>(type) << " at " << q;
    }
  }
  EXPECT_EQ(WallKernel<3>(1.0, KernelType::quadratic).terms().size(), 1u);  // no knot inside its support
}

// ---- Planes, edges and corners: the solid (or the fluid) is where the first k coordinates are negative (positive)

template <int Dim>
void expect_corner(int k, bool concave) {
  const double h = 0.7;
  std::mt19937 random(17 * Dim + k);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const KernelType type : all_kernels) {
    const Kernel<Dim> kernel(h, type);
    const double far = 1.5 * kernel.support_radius();
    Box<Dim> region{Vec<Dim>::Constant(-far), Vec<Dim>::Constant(far)};  // solid, or fluid where concave
    for (int axis = 0; axis < k; ++axis) (concave ? region.lower : region.upper)[axis] = 0.0;
    std::vector<Facet<Dim>> facets;
    for (int axis = 0; axis < k; ++axis) append_face(region, axis, !concave, facets);
    if (concave)
      for (auto& facet : facets) facet.normal = -facet.normal;

    for (int trial = 0; trial < 3; ++trial) {
      Vec<Dim> point = 0.3 * kernel.support_radius() * Vec<Dim>::NullaryExpr([&] { return uniform(random); });
      for (int axis = 0; axis < k; ++axis) point[axis] = concave || axis == 0 ? std::abs(point[axis]) : point[axis];
      SolidIntegrals<Dim> want = integrate_box(kernel, region, point, n_panels<Dim>);
      if (concave) {  // all of space less the fluid
        SolidIntegrals<Dim> space{1.0, Vec<Dim>::Zero(), Mat<Dim>::Identity()};
        space += -1.0 * want;
        want = space;
      }
      SCOPED_TRACE(fmt::format("{}D kernel {} trial {}", Dim, static_cast<int>(type), trial));
      expect_near(integrate_facets<Dim>(WallKernel<Dim>(h, type), facets, point), want, h, oracle_tolerance<Dim>);
    }
  }
}

TEST(WallIntegrals, PlaneMatchesVolumeQuadrature) {
  expect_corner<1>(1, false);
  expect_corner<2>(1, false);
  expect_corner<3>(1, false);
}
TEST(WallIntegrals, ConvexCornersMatchVolumeQuadrature) {
  expect_corner<2>(2, false);
  expect_corner<3>(2, false);
  expect_corner<3>(3, false);
}
TEST(WallIntegrals, ConcaveCornersMatchVolumeQuadrature) {
  expect_corner<2>(2, true);
  expect_corner<3>(2, true);
  expect_corner<3>(3, true);
}

// ---- Closed bodies

template <int Dim>
void expect_closed_box(const Box<Dim>& box, const Vec<Dim>& point, bool inside) {
  const double h = 0.7;
  for (const KernelType type : all_kernels) {
    auto want = integrate_box(Kernel<Dim>(h, type), box, point, n_panels<Dim>);
    if (inside) {
      want.volume -= 1.0;
      want.moment -= Mat<Dim>::Identity();
    }
    const auto got = integrate_facets<Dim>(WallKernel<Dim>(h, type), surface_of(box), point);
    SCOPED_TRACE(fmt::format("{}D kernel {}", Dim, static_cast<int>(type)));
    expect_near(got, want, h, oracle_tolerance<Dim>);
    // int y (x) grad_i W is symmetric, W being radial, whatever the solid.
    EXPECT_LE((got.moment - got.moment.transpose()).norm(), 1e-12);
  }
}

template <int Dim>
void expect_closed_boxes() {
  const Vec<Dim> offset = Vec3(0.31, -0.2, 0.13).head<Dim>();
  // Inside the support altogether; through its boundary; around the point.
  expect_closed_box<Dim>({offset, offset + Vec3(0.4, 0.6, 0.35).head<Dim>()}, Vec<Dim>::Zero(), false);
  expect_closed_box<Dim>({offset, offset + Vec3(3.0, 0.6, 2.0).head<Dim>()}, Vec<Dim>::Zero(), false);
  expect_closed_box<Dim>({-offset.cwiseAbs(), offset.cwiseAbs() + Vec3(0.3, 2.5, 0.2).head<Dim>()}, Vec<Dim>::Zero(),
                         true);
}

TEST(WallIntegrals, ClosedBoxesMatchVolumeQuadrature) {
  expect_closed_boxes<1>();
  expect_closed_boxes<2>();
  expect_closed_boxes<3>();
}

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

/// Whether `point` is inside a convex body.
template <int Dim>
bool inside_body(const std::vector<Facet<Dim>>& facets, const Vec<Dim>& point) {
  return std::ranges::all_of(facets, [&](const auto& f) { return f.normal.dot(point - f.corners[0]) < 0.0; });
}

// The rotated counterpart of the boxes: skew facets, crossed by the support in every way, must give what any closed
// body does.
template <int Dim>
void expect_random_bodies() {
  std::mt19937 random(5);
  int n_inside = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const auto body = random_body<Dim>(random, trial % 2 ? 2.5 : 0.8);
    for (const KernelType type : all_kernels) {
      const WallKernel<Dim> kernel(0.7, type);
      const auto sum = integrate_facets<Dim>(kernel, body, Vec<Dim>::Zero());
      const bool inside = inside_body<Dim>(body, Vec<Dim>::Zero());
      n_inside += inside;
      const double solid = sum.volume + (inside ? 1.0 : 0.0);
      EXPECT_LE((sum.moment - sum.moment.transpose()).norm(), 1e-11) << "trial " << trial;
      EXPECT_GE(solid, -1e-12) << "trial " << trial;
      EXPECT_LE(solid, 1.0 + 1e-12) << "trial " << trial;
    }
  }
  EXPECT_GT(n_inside, 100);
}
TEST(WallIntegrals, RandomBodiesHaveSymmetricMoments) {
  expect_random_bodies<2>();
  expect_random_bodies<3>();
}

// d/dx0 of int_solid W dV is int_solid grad_i W dV: `solid` against `area`, two different closed forms.
TEST(WallIntegrals, GradientOfTheSolidIsMinusTheSumOfAreas) {
  std::mt19937 random(11);
  int n_checked = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const auto body = random_body<3>(random, 1.5);
    const double eps = 1e-4;
    // Across a facet the sum drops by 1.
    const auto distance = [&](const auto& f) { return std::abs(f.normal.dot(f.corners[0])); };
    if (std::ranges::any_of(body, [&](const auto& f) { return distance(f) < 2.0 * eps; })) continue;
    ++n_checked;
    for (const KernelType type : all_kernels) {
      const WallKernel<3> kernel(0.7, type);
      Vec3 finite;
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 step = eps * Vec3::Unit(axis);
        finite[axis] =
            (integrate_facets<3>(kernel, body, step).volume - integrate_facets<3>(kernel, body, -step).volume) /
            (2.0 * eps);
      }
      EXPECT_LE((finite - integrate_facets<3>(kernel, body, Vec3::Zero()).gradient).norm(), 1e-6) << "trial " << trial;
    }
  }
  EXPECT_GT(n_checked, 80);
}

// ---- Single facets

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
TEST(WallIntegrals, RandomFacetsMatchQuadrature) {
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
TEST(WallIntegrals, ATriangleIsTheSumOfItsParts) {
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

TEST(WallIntegrals, ASegmentIsTheSumOfItsParts) {
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
TEST(WallIntegrals, AreaAndFirstMomentAreContinuousEverywhere) {
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
TEST(WallIntegrals, AWholePlaneFromTheFrontAndFromBehind) {
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

TEST(WallIntegrals, FacetsWithoutExtentAddNothing) {
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
TEST(WallIntegrals, FacetsOutsideTheSupportAddNothing) {
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
