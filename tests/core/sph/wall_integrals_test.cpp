#include "core/sph/wall_integrals.h"

#include "tests/core/sph/quadrature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <vector>

namespace smelt {
namespace {

// ---- The oracle: quadrature of the kernel itself, without any of the divergence theorem

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

}  // namespace
}  // namespace smelt
