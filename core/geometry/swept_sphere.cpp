#include "core/geometry/swept_sphere.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

template <int Dim>
Vec<Dim> closest_on_segment(const Vec<Dim>& p, const Vec<Dim>& a, const Vec<Dim>& b) {
  const Vec<Dim> ab = b - a;
  const double length2 = ab.squaredNorm();
  if (length2 == 0.0) return a;
  return a + std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) * ab;
}

/// Smallest t in [0, 1] at which |offset + t direction| = radius, coming from outside. Measured from the point of
/// closest approach: its distance is known to a rounding of |offset|, where the difference of squares in b^2 - a c
/// would lose a short radius far away.
template <typename Vector>
std::optional<double> enter_ball(const Vector& offset, const Vector& direction, double radius) {
  const double a = direction.squaredNorm();
  const double b = offset.dot(direction);
  if (b >= 0.0 || a == 0.0) return std::nullopt;
  const double nearest = -b / a;
  const double half2 = radius * radius - (offset + nearest * direction).squaredNorm();
  if (half2 < 0.0) return std::nullopt;
  const double t = nearest - std::sqrt(half2 / a);
  if (t > 1.0) return std::nullopt;
  return std::max(t, 0.0);
}

template <int Dim>
void keep_earlier(std::optional<SweepContact<Dim>>& best, double time, const Vec<Dim>& from_obstacle) {
  if (best && best->time <= time) return;
  const double length = from_obstacle.norm();
  if (length > 0.0) best = SweepContact<Dim>{time, from_obstacle / length};
}

template <int Dim>
void sweep_corner(const Vec<Dim>& centre, const Vec<Dim>& displacement, double radius, const Vec<Dim>& corner,
                  std::optional<SweepContact<Dim>>& best) {
  const Vec<Dim> offset = centre - corner;
  if (const auto t = enter_ball(offset, displacement, radius)) keep_earlier<Dim>(best, *t, offset + *t * displacement);
}

/// The side of an edge: a cylinder in 3D, two parallel lines in 2D.
template <int Dim>
void sweep_edge(const Vec<Dim>& centre, const Vec<Dim>& displacement, double radius, const Vec<Dim>& a,
                const Vec<Dim>& b, std::optional<SweepContact<Dim>>& best) {
  const Vec<Dim> edge = b - a;
  const double length2 = edge.squaredNorm();
  if (length2 == 0.0) return;
  const Vec<Dim> offset = centre - a;
  const Vec<Dim> offset_across = offset - offset.dot(edge) / length2 * edge;
  const Vec<Dim> displacement_across = displacement - displacement.dot(edge) / length2 * edge;
  const auto t = enter_ball(offset_across, displacement_across, radius);
  if (!t) return;
  const double along = (offset + *t * displacement).dot(edge) / length2;
  if (along >= 0.0 && along <= 1.0) keep_earlier<Dim>(best, *t, offset_across + *t * displacement_across);
}

/// a b - c d to the last bit or two, however much of it cancels (Kahan: the rounding of c d is added back).
double difference_of_products(double a, double b, double c, double d) {
  const double product = c * d;
  return std::fma(a, b, -product) + std::fma(-c, d, product);
}

/// Normals of slivers have few digits left in a plain cross product.
Vec3 exact_cross(const Vec3& a, const Vec3& b) {
  return {difference_of_products(a[1], b[2], a[2], b[1]), difference_of_products(a[2], b[0], a[0], b[2]),
          difference_of_products(a[0], b[1], a[1], b[0])};
}

/// By winding, as long as twice the area.
Vec3 normal_of(const Simplex<3>& t) {
  return exact_cross(t[1] - t[0], t[2] - t[0]);
}

bool inside_triangle(const Vec3& p, const Simplex<3>& t, const Vec3& normal) {
  for (int k = 0; k < 3; ++k)
    if ((t[(k + 1) % 3] - t[k]).cross(p - t[k]).dot(normal) < 0.0) return false;
  return true;
}

void sweep_face(const Vec3& centre, const Vec3& displacement, double radius, const Simplex<3>& t, Vec3 normal,
                std::optional<SweepContact<3>>& best) {
  const double length = normal.norm();
  if (length == 0.0) return;
  normal /= length;
  const Vec3 offset = centre - t[0];
  const double distance = offset.dot(normal);
  const double side = distance >= 0.0 ? 1.0 : -1.0;
  const double approach = -side * displacement.dot(normal);
  if (approach <= 0.0) return;
  // A sphere that touches may come out a few roundings deep here: that is contact now, not contact missed.
  const double gap = side * distance - radius;
  const double rounding = 1e-9 * radius + 1e-15 * offset.norm();
  const double time = gap < 0.0 && gap > -rounding ? 0.0 : gap / approach;
  if (time < 0.0 || time > 1.0) return;
  if (inside_triangle(centre + time * displacement, t, normal)) keep_earlier<3>(best, time, side * normal);
}

/// A little more than a distance [m] of places near `offset`, whatever rounding does.
template <int Dim>
double surely_beyond(double distance, const Vec<Dim>& offset) {
  return (1.0 + 1e-6) * distance + 1e-12 * offset.template lpNorm<1>();
}

/// Whether the boxes of the simplex and of the moving sphere are apart: most of what a broad phase hands over.
template <int Dim>
bool boxes_are_apart(const Vec<Dim>& centre, const Vec<Dim>& displacement, double radius, const Simplex<Dim>& simplex) {
  Vec<Dim> lower = simplex[0], upper = simplex[0];
  for (int k = 1; k < Dim; ++k) {
    lower = lower.cwiseMin(simplex[k]);
    upper = upper.cwiseMax(simplex[k]);
  }
  const Vec<Dim> end = centre + displacement;
  return (lower.array() > centre.cwiseMax(end).array() + radius).any() ||
         (upper.array() < centre.cwiseMin(end).array() - radius).any();
}

}  // namespace

template <>
Vec<1> closest_point<1>(const Vec<1>&, const Simplex<1>& point) {
  return point[0];
}

template <>
Vec<2> closest_point<2>(const Vec<2>& p, const Simplex<2>& segment) {
  return closest_on_segment<2>(p, segment[0], segment[1]);
}

template <>
Vec3 closest_point<3>(const Vec3& p, const Simplex<3>& t) {
  const Vec3 normal = normal_of(t);
  const double area2 = normal.squaredNorm();
  if (area2 > 0.0) {
    const Vec3 foot = p - (p - t[0]).dot(normal) / area2 * normal;
    if (inside_triangle(foot, t, normal)) return foot;
  }
  Vec3 best = closest_on_segment<3>(p, t[0], t[1]);
  for (int k = 1; k < 3; ++k) {
    const Vec3 candidate = closest_on_segment<3>(p, t[k], t[(k + 1) % 3]);
    if ((candidate - p).squaredNorm() < (best - p).squaredNorm()) best = candidate;
  }
  return best;
}

template <int Dim>
std::optional<SweepContact<Dim>> sweep_sphere(const Vec<Dim>& centre, const Vec<Dim>& displacement, double radius,
                                              const Simplex<Dim>& simplex, double until) {
  if (boxes_are_apart<Dim>(centre, displacement, radius, simplex)) return std::nullopt;
  const Vec<Dim> offset = centre - simplex[0];
  // Most of the rest pass by on one side of the triangle's plane.
  bool apart_at_start = false;
  Vec<Dim> normal = Vec<Dim>::Zero();
  if constexpr (Dim == 3) {
    normal = normal_of(simplex);
    const double start = offset.dot(normal), end = start + until * displacement.dot(normal);
    const double clear = surely_beyond<3>(radius, offset), clear2 = clear * clear * normal.squaredNorm();
    apart_at_start = start * start > clear2;
    if (apart_at_start && end * end > clear2 && (start > 0.0) == (end > 0.0)) return std::nullopt;
  }
  const Vec<Dim> from_obstacle = centre - closest_point<Dim>(centre, simplex);
  const double distance = from_obstacle.norm();
  // In contact at the start: what counts is whether it moves deeper. From a place on the obstacle itself every way
  // leads out.
  if (distance <= radius) {
    if (distance == 0.0 || displacement.dot(from_obstacle) >= 0.0) return std::nullopt;
    return SweepContact<Dim>{0.0, from_obstacle / distance};
  }
  if (distance > surely_beyond<Dim>(radius + until * displacement.norm(), offset)) return std::nullopt;

  std::optional<SweepContact<Dim>> best;
  if constexpr (Dim == 3) sweep_face(centre, displacement, radius, simplex, normal, best);
  if constexpr (Dim >= 2)
    for (int k = 0; k < (Dim == 3 ? 3 : 1); ++k)
      sweep_edge<Dim>(centre, displacement, radius, simplex[k], simplex[(k + 1) % Dim], best);
  for (const Vec<Dim>& corner : simplex) sweep_corner<Dim>(centre, displacement, radius, corner, best);
  return best;
}

template std::optional<SweepContact<1>> sweep_sphere<1>(const Vec<1>&, const Vec<1>&, double, const Simplex<1>&,
                                                        double);
template std::optional<SweepContact<2>> sweep_sphere<2>(const Vec<2>&, const Vec<2>&, double, const Simplex<2>&,
                                                        double);
template std::optional<SweepContact<3>> sweep_sphere<3>(const Vec<3>&, const Vec<3>&, double, const Simplex<3>&,
                                                        double);

}  // namespace smelt
