#include "core/sph/wall_integrals.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace smelt {

namespace {

// ---- Radial polynomials

constexpr int n_coefficients = std::tuple_size_v<RadialPolynomial>;
constexpr int shape_degree = 5;  // the quintic spline's, the highest of all

double evaluate(const RadialPolynomial& p, double q) {
  double value = 0.0;
  for (int k = n_coefficients; k-- > 0;) value = value * q + p[k];
  return value;
}

/// The kernel's polynomial between the knots `knot` and `knot` + 1: Newton's interpolation. At these nodes, multiples
/// of 1/8, values and divided differences are short binary fractions, so the coefficients come out exact.
RadialPolynomial kernel_piece(KernelType type, int knot) {
  constexpr int n = shape_degree + 1;
  const auto node = [&](int i) { return knot + i / 8.0; };
  std::array<double, n> difference;
  for (int i = 0; i < n; ++i) difference[i] = kernel_shape(type, node(i));
  for (int order = 1; order < n; ++order)
    for (int i = n - 1; i >= order; --i)
      difference[i] = (difference[i] - difference[i - 1]) / (node(i) - node(i - order));

  RadialPolynomial p{};
  for (int i = n - 1; i >= 0; --i) {  // p <- p (q - node) + difference
    for (int k = n - 1; k > 0; --k) p[k] = p[k - 1] - node(i) * p[k];
    p[0] = difference[i] - node(i) * p[0];
  }
  CHECK_LT(std::abs(evaluate(p, node(7)) - kernel_shape(type, node(7))),
           1e-10 * kernel_shape(type, 0.0));  // no knot between integers
  return p;
}

/// int_q^end p s^power ds; p has no terms s^k with k + power = -1, nor does the result exceed the array.
RadialPolynomial integrate_to(double end, const RadialPolynomial& p, int power) {
  RadialPolynomial integral{};
  for (int k = 0; k < n_coefficients; ++k) {
    if (p[k] == 0.0) continue;
    const int degree = k + power + 1;
    CHECK_GT(degree, 0);
    CHECK_LT(degree, n_coefficients);
    integral[degree] = -p[k] / degree;
    integral[0] += p[k] / degree * std::pow(end, degree);
  }
  return integral;
}

template <int Dim>
RadialTerm make_term(double radius, const RadialPolynomial& shape) {
  RadialTerm term{.radius = radius, .shape = shape};
  term.ring = integrate_to(radius, shape, 1);
  term.ray = integrate_to(radius, shape, Dim - 1);
  // The constant of N gives N_0 (1/q - 1/radius).
  if constexpr (Dim == 3) {
    RadialPolynomial rest = term.ray;
    rest[0] = 0.0;
    term.cone = integrate_to(radius, rest, -2);
    term.cone[0] -= term.ray[0] / radius;
    term.cone_pole = term.ray[0];
  }
  return term;
}

// ---- Integrals along a straight line

/// A piece t0 <= t <= t1 of a line at distance b from the centre; r^2 = b^2 + t^2.
struct LinePiece {
  double t0, t1;
  double r0, r1;
};

/// The piece from t0 to t1 of a line at distance b.
LinePiece line_piece(double t0, double t1, double b2) {
  return {t0, t1, std::sqrt(b2 + t0 * t0), std::sqrt(b2 + t1 * t1)};
}

/// The part of `line` inside the ball of radius `radius`; false where there is none.
bool clip(const LinePiece& line, double b2, double radius, LinePiece& piece) {
  const double half2 = radius * radius - b2;
  if (half2 <= 0.0) return false;
  const double half = std::sqrt(half2);
  if (line.t0 >= half || line.t1 <= -half) return false;
  piece = line;
  if (line.t0 < -half) piece.t0 = -half, piece.r0 = radius;
  if (line.t1 > half) piece.t1 = half, piece.r1 = radius;
  return true;
}

/// int dt/r = [asinh(t/b)], in whichever form has no difference of nearly equal numbers. It only stands with a factor
/// of b or less: 0 where b is so small that the quotient could overflow.
double integrate_inverse(const LinePiece& p, double b2) {
  if (b2 < 1e-300) return 0.0;
  if (p.t0 >= 0.0) return std::log((p.t1 + p.r1) / (p.t0 + p.r0));
  if (p.t1 <= 0.0) return std::log((p.r0 - p.t0) / (p.r1 - p.t1));
  return std::log((p.t1 + p.r1) * (p.r0 - p.t0) / b2);
}

/// int r^k dt for all k >= 0, by parts: (k+1) int r^k dt = [t r^k] + k b^2 int r^(k-2) dt.
RadialPolynomial integrate_powers(const LinePiece& p, double b2, double inverse) {
  RadialPolynomial integral;
  double end0 = p.t0, end1 = p.t1;
  for (int k = 0; k < n_coefficients; ++k) {
    const double lower = k >= 2 ? integral[k - 2] : k == 1 ? inverse : 0.0;
    integral[k] = (end1 - end0 + k * b2 * lower) / (k + 1);
    end0 *= p.r0;
    end1 *= p.r1;
  }
  return integral;
}

double dot(const RadialPolynomial& p, const RadialPolynomial& moments) {
  double sum = 0.0;
  for (int k = 0; k < n_coefficients; ++k) sum += p[k] * moments[k];
  return sum;
}

// ---- Facets, in units of h, seen from the origin. d: distance of the origin in front of the facet's plane.

template <int Dim>
using Corners = std::array<Vec<Dim>, Dim>;

void accumulate_point(std::span<const RadialTerm> terms, double d, FacetIntegrals<1>& sum) {
  for (const RadialTerm& term : terms) {
    if (std::abs(d) >= term.radius) break;
    sum.area += evaluate(term.shape, std::abs(d));
    sum.solid += evaluate(term.ray, std::abs(d));
  }
}

void accumulate_segment(std::span<const RadialTerm> terms, double d, const Corners<2>& corner, FacetIntegrals<2>& sum) {
  const Vec<2> along = (corner[1] - corner[0]).normalized();
  const double height = std::abs(d), b2 = d * d;
  const LinePiece line = line_piece(corner[0].dot(along), corner[1].dot(along), b2);
  double first = 0.0;
  for (const RadialTerm& term : terms) {
    LinePiece piece;
    if (!clip(line, b2, term.radius, piece)) break;
    const RadialPolynomial powers = integrate_powers(piece, b2, integrate_inverse(piece, b2));
    sum.area += dot(term.shape, powers);
    first += evaluate(term.ring, piece.r0) - evaluate(term.ring, piece.r1);
    // int N dtheta with dtheta = height dt/r^2; N has no term in q.
    sum.solid += term.ray[0] * (std::atan2(piece.t1, height) - std::atan2(piece.t0, height));
    for (int k = 2; k < n_coefficients; ++k) sum.solid += height * term.ray[k] * powers[k - 2];
  }
  sum.first += first * along;
}

/// One edge of a triangle, seen from the foot of the perpendicular from the origin to its plane.
struct Edge {
  Vec3 along, outward;  ///< unit, in the plane; outward where the corners go round counter-clockwise about the normal
  double a = 0.0;       ///< distance of the foot from the edge, positive where the foot is inside [-]
  double b2 = 0.0;      ///< squared distance of the origin from the edge
  LinePiece line{};
  double angle = 0.0;  ///< that the edge subtends at the foot
};

/// The angle phi at the foot, a -> 0 included: no angle where the foot is on the edge's line.
double subtended_angle(const LinePiece& p, double a) {
  return a == 0.0 ? 0.0 : std::atan2(a * (p.t1 - p.t0), a * a + p.t0 * p.t1);
}

/// Takes away what lies outside the edge, within the support: area by int ring(r) dphi, first by outward int ring(r)
/// dt, solid by int height cone(r) dphi. With rho^2 = r^2 - height^2 = a^2 + t^2 and dphi = a dt/rho^2, the angular
/// moments J_k = int r^k dphi follow from I_k = int r^k dt:
///   J_k = a I_(k-2) + height^2 J_(k-2),  height J_(-1) = psi = [atan(height t/(a r))].
void subtract_outside(const RadialTerm& term, double height, const Edge& edge, const LinePiece& p,
                      FacetIntegrals<3>& sum) {
  const double a = edge.a;
  const double inverse = integrate_inverse(p, edge.b2);
  const RadialPolynomial powers = integrate_powers(p, edge.b2, inverse);
  sum.first -= dot(term.ring, powers) * edge.outward;
  if (a == 0.0) return;

  const bool whole = p.t0 == edge.line.t0 && p.t1 == edge.line.t1;
  const double psi =
      std::atan2(a * height * (p.t1 * p.r0 - p.t0 * p.r1), a * a * p.r0 * p.r1 + height * height * p.t0 * p.t1);
  RadialPolynomial angular;
  angular[0] = whole ? edge.angle : subtended_angle(p, a);
  angular[1] = a * inverse + height * psi;
  for (int k = 2; k < n_coefficients; ++k) angular[k] = a * powers[k - 2] + height * height * angular[k - 2];
  sum.area -= dot(term.ring, angular);
  sum.solid -= term.cone_pole * psi + height * dot(term.cone, angular);
}

void accumulate_triangle(std::span<const RadialTerm> terms, double d, const Corners<3>& corner, const Vec3& normal,
                         FacetIntegrals<3>& sum) {
  const double height = std::abs(d);
  std::array<Edge, 3> edges;
  bool edge_in_support = false, foot_inside = true;
  for (int k = 0; k < 3; ++k) {
    const Vec3 &begin = corner[k], &end = corner[(k + 1) % 3];
    Edge& edge = edges[k];
    edge.along = (end - begin).normalized();
    edge.outward = edge.along.cross(normal);
    // Taken at the middle, so that the two triangles on an edge agree to the last bit on which side of it the foot is.
    edge.a = 0.5 * (begin + end).dot(edge.outward);
    edge.b2 = edge.a * edge.a + d * d;
    edge.line = line_piece(begin.dot(edge.along), end.dot(edge.along), edge.b2);
    LinePiece piece;
    edge_in_support |= clip(edge.line, edge.b2, terms[0].radius, piece);
    foot_inside &= edge.a > 0.0;
  }
  if (!edge_in_support && !foot_inside) return;

  // A whole disc about the foot (or the angle that the edges leave of it), less what lies outside the edges.
  double angle = 2.0 * std::numbers::pi;
  if (edge_in_support) {
    angle = 0.0;
    for (Edge& edge : edges) angle += edge.angle = subtended_angle(edge.line, edge.a);
  }
  for (const RadialTerm& term : terms) {
    if (height >= term.radius) break;
    sum.area += angle * evaluate(term.ring, height);
    sum.solid += angle * (term.cone_pole + height * evaluate(term.cone, height));
    for (const Edge& edge : edges) {
      LinePiece piece;
      if (clip(edge.line, edge.b2, term.radius, piece)) subtract_outside(term, height, edge, piece, sum);
    }
  }
}

/// Whether the bounding box of the corners misses the cube around the support.
template <int Dim>
bool misses_support(const Corners<Dim>& corner, double radius) {
  Box<Dim> box;
  for (const Vec<Dim>& x : corner) box.extend(x);
  return (box.lower.array() >= radius).any() || (box.upper.array() <= -radius).any();
}

}  // namespace

template <int Dim>
WallKernel<Dim>::WallKernel(double smoothing_length, KernelType type)
    : h_(smoothing_length), kappa_(kernel_kappa(type)) {
  CHECK_GT(smoothing_length, 0.0);
  const double sigma = kernel_normalisation<Dim>(type);
  RadialPolynomial outer{};
  for (int knot = static_cast<int>(kappa_); knot > 0; --knot) {
    const RadialPolynomial inner = kernel_piece(type, knot - 1);
    RadialPolynomial step;
    for (int k = 0; k < n_coefficients; ++k) step[k] = sigma * (inner[k] - outer[k]);
    if (std::ranges::any_of(step, [](double c) { return c != 0.0; })) terms_[n_terms_++] = make_term<Dim>(knot, step);
    outer = inner;
  }
}

PlaneIntegral integrate_plane(const WallKernel<3>& kernel, double distance) {
  const double h = kernel.smoothing_length(), q = distance / h;
  PlaneIntegral plane;
  for (const RadialTerm& term : kernel.terms()) {
    if (q >= term.radius) break;
    plane.area += 2.0 * std::numbers::pi / h * evaluate(term.ring, q);
    plane.slope -= 2.0 * std::numbers::pi / (h * h) * q * evaluate(term.shape, q);
  }
  return plane;
}

template <int Dim>
FacetIntegrals<Dim> integrate_facet(const WallKernel<Dim>& kernel, const Simplex<Dim>& facet, const Vec<Dim>& normal,
                                    const Vec<Dim>& point) {
  FacetIntegrals<Dim> sum;
  const auto terms = kernel.terms();
  const double h = kernel.smoothing_length(), inverse_h = 1.0 / h;
  const double d = (point - facet[0]).dot(normal) * inverse_h;
  if (std::abs(d) >= terms[0].radius) return sum;
  Corners<Dim> corner;
  for (int k = 0; k < Dim; ++k) corner[k] = (facet[k] - point) * inverse_h;
  if (misses_support<Dim>(corner, terms[0].radius)) return sum;

  if constexpr (Dim == 1) {
    accumulate_point(terms, d, sum);
  } else if constexpr (Dim == 2) {
    if (facet[0] == facet[1]) return sum;
    accumulate_segment(terms, d, corner, sum);
  } else {
    const Vec3 ab = corner[1] - corner[0], ac = corner[2] - corner[0];
    const double area = ab.cross(ac).dot(normal);  // twice
    const double longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    if (std::abs(area) <= 2e-14 * longest2) return sum;
    if (area < 0.0) std::swap(corner[1], corner[2]);
    accumulate_triangle(terms, d, corner, normal, sum);
  }
  sum.first -= d * sum.area * normal;
  sum.area *= inverse_h;
  if (d < 0.0) sum.solid = -sum.solid;
  return sum;
}

template <int Dim>
FacetIntegrals<Dim> integrate_small_facet(const WallKernel<Dim>& kernel, const Simplex<Dim>& facet,
                                          const Vec<Dim>& normal, const Vec<Dim>& point) {
  FacetIntegrals<Dim> sum;
  Vec<Dim> y = -point;
  for (const Vec<Dim>& corner : facet) y += corner / Dim;
  const double r = y.norm(), h = kernel.smoothing_length(), q = r / h;
  double size = 1.0;
  if constexpr (Dim == 2) size = (facet[1] - facet[0]).norm();
  if constexpr (Dim == 3) size = 0.5 * (facet[1] - facet[0]).cross(facet[2] - facet[0]).norm();
  double value = 0.0, ray = 0.0;
  for (const RadialTerm& term : kernel.terms()) {
    if (q >= term.radius) break;
    value += evaluate(term.shape, q);
    ray += evaluate(term.ray, q);
  }
  sum.area = size * value / std::pow(h, Dim);
  sum.first = sum.area * y;
  // The solid angle it fills, signed by the side.
  sum.solid = -size * y.dot(normal) / std::pow(r, Dim) * ray;
  return sum;
}

#define SMELT_INSTANTIATE(Dim)                                                                                    \
  template class WallKernel<Dim>;                                                                                 \
  template FacetIntegrals<Dim> integrate_facet<Dim>(const WallKernel<Dim>&, const Simplex<Dim>&, const Vec<Dim>&, \
                                                    const Vec<Dim>&);                                             \
  template FacetIntegrals<Dim> integrate_small_facet<Dim>(const WallKernel<Dim>&, const Simplex<Dim>&,            \
                                                          const Vec<Dim>&, const Vec<Dim>&);
SMELT_INSTANTIATE(1)
SMELT_INSTANTIATE(2)
SMELT_INSTANTIATE(3)
#undef SMELT_INSTANTIATE

}  // namespace smelt
