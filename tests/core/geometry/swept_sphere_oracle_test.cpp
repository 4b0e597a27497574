// Swept spheres against a brute-force oracle in higher precision, on triangles that are random and on ones that are
// nasty.
//
// The oracle shares no algebra with core/geometry/swept_sphere.cpp: it knows only the distance D(t) of the moving
// centre to a triangle, convex in t as a triangle is convex, and finds where it falls below the radius by bisection, in
// long double or __float128.
//
// Agreement is asked for in the radius: what was found must be exact for a sphere whose radius differs by no more than
//   delta = 1e-9 r + 16 eps (|coordinates| + |displacement|),
// that is, no hit is missed and no contact found late by more than delta of depth. A bound on the time itself would
// mean nothing: where a sphere grazes, the time changes by the square root of what the radius changes by. The first
// term is what double leaves of a sliver's normal (roundings of edges a thousand times as long as the sliver is thick),
// a thousandth of the 1e-6 that nothing may be deeper than; the second is the rounding of the places themselves.

#include "core/geometry/swept_sphere.h"
#include "core/sph/collision.h"
#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

namespace smelt {
namespace {

// ---- The oracle

/// Of an interval of [0, 1], until a bit is left of it.
template <typename Real>
constexpr int n_halvings = std::is_same_v<Real, long double> ? 66 : 114;

template <typename Real>
struct Point {
  Real x, y, z;
};
template <typename Real>
Point<Real> operator+(const Point<Real>& a, const Point<Real>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename Real>
Point<Real> operator-(const Point<Real>& a, const Point<Real>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename Real>
Point<Real> operator*(Real s, const Point<Real>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <typename Real>
Real dot(const Point<Real>& a, const Point<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename Real>
Point<Real> widened(const Vec3& v) {
  return {static_cast<Real>(v[0]), static_cast<Real>(v[1]), static_cast<Real>(v[2])};
}

/// From the triangle's nearest point to the origin, the triangle given relative to it: the least |a + u ab + v ac| with
/// u, v >= 0 and u + v <= 1, by completing the square (u across ab first, then v); where that minimum lies outside, on
/// the sides.
template <typename Real>
Point<Real> to_origin(const Point<Real>& a, const Point<Real>& b, const Point<Real>& c) {
  const auto along_side = [](const Point<Real>& from, const Point<Real>& to) {
    const Point<Real> side = to - from;
    const Real length2 = dot(side, side);
    if (length2 == 0) return from;
    Real s = -dot(from, side) / length2;
    s = s < 0 ? 0 : s > 1 ? 1 : s;
    return from + s * side;
  };
  const Point<Real> ab = b - a, ac = c - a;
  const Real ab2 = dot(ab, ab);
  if (ab2 > 0) {
    // The part of ac that is perpendicular to ab; taken twice, since once leaves roundings of ac in a sliver.
    Point<Real> across = ac - (dot(ac, ab) / ab2) * ab;
    across = across - (dot(across, ab) / ab2) * ab;
    const Real across2 = dot(across, across);
    if (across2 > 0) {
      const Real v = -dot(a, across) / across2;
      const Real u = -dot(a + v * ac, ab) / ab2;
      if (u >= 0 && v >= 0 && u + v <= 1) {
        // In the plane's normal direction: take both components away, twice again.
        Point<Real> height = a;
        for (int pass = 0; pass < 2; ++pass)
          height = height - (dot(height, ab) / ab2) * ab - (dot(height, across) / across2) * across;
        return height;
      }
    }
  }
  Point<Real> best = along_side(a, b);
  for (const Point<Real>& other : {along_side(b, c), along_side(c, a)})
    if (dot(other, other) < dot(best, best)) best = other;
  return best;
}

/// A sphere's centre on its way past one triangle.
template <typename Real>
class Passing {
 public:
  Passing(const Vec3& centre, const Vec3& displacement, const Simplex<3>& t)
      : displacement_(widened<Real>(displacement)) {
    for (int k = 0; k < 3; ++k) corner_[k] = widened<Real>(t[k]) - widened<Real>(centre);
  }

  /// From the centre at time t to the triangle.
  Point<Real> way(Real t) const {
    const Point<Real> moved = t * displacement_;
    return to_origin<Real>(corner_[0] - moved, corner_[1] - moved, corner_[2] - moved);
  }
  Real distance2(Real t) const {
    const Point<Real> w = way(t);
    return dot(w, w);
  }
  bool approaches(Real t) const { return dot(way(t), displacement_) > 0; }
  /// Whether it starts out along the surface, neither in nor out, to within `angle`: then both are right.
  bool starts_along(double angle) const {
    const Point<Real> w = way(0);
    const Real approach = dot(w, displacement_);
    return approach * approach <= static_cast<Real>(angle * angle) * dot(w, w) * dot(displacement_, displacement_);
  }

  /// When the distance in [0, 1] is least: it is convex, so that its slope changes sign once.
  Real nearest_time() const {
    if (!approaches(0)) return 0;
    if (approaches(1)) return 1;
    Real before = 0, after = 1;
    for (int k = 0; k < n_halvings<Real>; ++k) {
      const Real middle = (before + after) / 2;
      (approaches(middle) ? before : after) = middle;
    }
    return (before + after) / 2;
  }

 private:
  std::array<Point<Real>, 3> corner_;
  Point<Real> displacement_;
};

/// When a sphere first comes within `radius`; infinity where it does not. One that starts within is in contact where it
/// gets deeper.
template <typename Real>
double oracle_time(const Passing<Real>& passing, Real radius) {
  const Real radius2 = radius * radius;
  if (passing.distance2(0) <= radius2) return passing.approaches(0) ? 0.0 : std::numeric_limits<double>::infinity();
  const Real nearest = passing.nearest_time();
  if (passing.distance2(nearest) > radius2) return std::numeric_limits<double>::infinity();
  Real before = 0, after = nearest;
  for (int k = 0; k < n_halvings<Real>; ++k) {
    const Real middle = (before + after) / 2;
    (passing.distance2(middle) > radius2 ? before : after) = middle;
  }
  return static_cast<double>(before);
}

// ---- Cases

/// Triangles and spheres of every unpleasant kind, at a scale and a place.
class Cases {
 public:
  explicit Cases(std::uint64_t seed) : random_(seed) {}

  double uniform(double lower, double upper) { return std::uniform_real_distribution<double>(lower, upper)(random_); }
  int one_of(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  Vec3 point() { return {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; }
  Vec3 direction() {
    Vec3 d = point();
    while (d.norm() < 0.1 || d.norm() > 1.0) d = point();
    return d.normalized();
  }

  Simplex<3> triangle() {
    Simplex<3> t{point(), point(), point()};
    const double thin = std::pow(10.0, uniform(-9, -1));
    switch (one_of(8)) {
      case 0:
        t[2] = t[0] + uniform(0.01, 0.99) * (t[1] - t[0]) + thin * point();
        break;  // a cap
      case 1:
        t[2] = t[1] + thin * point();
        break;  // a needle
      case 2:
        t[2] = t[one_of(2)];
        break;  // a segment
      case 3:
        t[1] = t[2] = t[0];
        break;  // a point
      case 4:
        t[2] = t[0] + uniform(-0.5, 1.5) * (t[1] - t[0]);
        break;  // collinear to a rounding
      case 5:   // on a lattice: faces along axes
        for (Vec3& x : t) x = (2.0 * x).array().round() / 2.0;
        break;
      default:
        break;
    }
    return t;
  }

  /// A place on it: inside, on an edge, at a corner.
  Vec3 aim_at(const Simplex<3>& t) {
    const int kind = one_of(4);
    if (kind == 0) return t[one_of(3)];
    const double u = uniform(0, 1);
    if (kind == 1) return t[0] + u * (t[1] - t[0]);
    const double v = uniform(0, 1 - u);
    return t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
  }

 private:
  std::mt19937_64 random_;
};

struct Sweep {
  Vec3 centre, displacement;
  double radius;
};

/// Towards a place on the triangle or a little past it: head on, grazing, overlapping at the start, at rest.
Sweep sweep_at(Cases& cases, const Simplex<3>& t) {
  Sweep s;
  s.radius = std::pow(10.0, cases.uniform(-5, -0.3));
  const Vec3 aim = cases.aim_at(t);
  const double distance = cases.one_of(3) == 0 ? s.radius * cases.uniform(0.0, 2.0) : cases.uniform(0.0, 3.0);
  Vec3 direction = cases.direction();
  if (cases.one_of(6) == 0) {  // along an axis
    direction.setZero();
    direction[cases.one_of(3)] = cases.one_of(2) ? 1.0 : -1.0;
  }
  s.centre = aim + distance * direction;
  Vec3 target = aim;
  if (cases.one_of(2) == 0)
    target += cases.uniform(0.5, 1.5) * s.radius * cases.direction();  // past it by about a radius
  s.displacement = cases.uniform(0.0, 1.5) * (target - s.centre);
  if (cases.one_of(20) == 0) s.displacement = -s.displacement;
  return s;
}

double tolerance(const Sweep& s, double magnitude) {
  return 1e-9 * s.radius + 16.0 * std::numeric_limits<double>::epsilon() * (magnitude + s.displacement.norm());
}

/// Whether `time` (or infinity) is that of a sphere whose radius is right to `delta`.
template <typename Real>
void expect_agreement(const Passing<Real>& passing, double radius, double delta, double time,
                      const std::string& which) {
  const double earliest = oracle_time<Real>(passing, static_cast<Real>(radius) + static_cast<Real>(delta));
  const double latest =
      oracle_time<Real>(passing, std::max(static_cast<Real>(radius) - static_cast<Real>(delta), Real(0)));
  // A sphere that overlaps as it is and one that just does not: both answers stand where the distance is the radius to
  // within delta.
  constexpr double of_time = 1e-15;
  const Real start = passing.distance2(0);
  const Real outer = static_cast<Real>(radius + delta), inner = static_cast<Real>(std::max(radius - delta, 0.0));
  const bool touches = start <= outer * outer && start >= inner * inner;
  if (touches && (time == 0.0 || earliest == time)) return;
  // So they do where it starts out along the surface, or so near to it that its side is a matter of rounding.
  const auto distance = std::sqrt(static_cast<double>(start));
  if (distance <= radius && (distance <= delta || passing.starts_along(delta / distance))) return;
  ASSERT_LE(time, latest + of_time) << which;
  if (!touches) {
    ASSERT_GE(time, earliest - of_time) << which;
  }
}

template <typename Real>
int check_triangles(std::uint64_t seed, int n, double scale, const Vec3& place) {
  Cases cases(seed);
  int n_hits = 0;
  for (int trial = 0; trial < n; ++trial) {
    Simplex<3> t = cases.triangle();
    Sweep s = sweep_at(cases, t);
    for (Vec3& x : t) x = place + scale * x;
    s.centre = place + scale * s.centre;
    s.displacement *= scale;
    s.radius *= scale;
    const Passing<Real> passing(s.centre, s.displacement, t);
    const auto contact = sweep_sphere<3>(s.centre, s.displacement, s.radius, t);
    const double time = contact ? contact->time : std::numeric_limits<double>::infinity();
    const double delta = tolerance(s, place.norm() + 3.0 * scale);
    const std::string which = fmt::format("seed {} trial {}", seed, trial);
    expect_agreement<Real>(passing, s.radius, delta, time, which);
    if (testing::Test::HasFatalFailure()) return n_hits;
    if (!contact) continue;
    ++n_hits;
    EXPECT_NEAR(contact->normal.norm(), 1.0, 1e-12) << which;
    EXPECT_LE(contact->normal.dot(s.displacement), 1e-9 * s.displacement.norm())
        << which << ": hit something it moves away from";
  }
  return n_hits;
}

TEST(SweptSphereOracle, OneTriangle) {
  const int n = full_run() ? 500000 : 10000;
  const int n_hits = check_triangles<long double>(1, n, 1.0, Vec3::Zero());
  EXPECT_GT(n_hits, n / 4);
  EXPECT_LT(n_hits, 3 * n / 4);
}

TEST(SweptSphereOracle, OneTriangleInFourfoldPrecision) {
  check_triangles<__float128>(2, full_run() ? 10000 : 500, 1.0, Vec3::Zero());
}

TEST(SweptSphereOracle, FarFromTheOriginAndAtEveryScale) {
  const int n = full_run() ? 20000 : 500;
  for (const double scale : {1e-6, 1.0, 1e4}) {
    check_triangles<long double>(3, n, scale, Vec3::Zero());
    check_triangles<long double>(4, n, scale, scale * Vec3(1e4, -3e4, 2e4));
  }
}

// ---- Soups: many triangles at once, through the broad phase and as one obstacle

/// A soup of nasty triangles: random ones, doubles of them, fans with a T-junction, a concave corner.
std::vector<Simplex<3>> make_soup(Cases& cases) {
  std::vector<Simplex<3>> soup;
  for (int k = 0; k < 6; ++k) soup.push_back(cases.triangle());
  soup.push_back(soup[0]);                               // a duplicate
  soup.push_back({soup[1][1], soup[1][0], soup[1][2]});  // the same from behind
  const Vec3 a = cases.point(), b = cases.point(), c = cases.point(), d = cases.point();
  const Vec3 middle = 0.5 * (a + b);
  soup.push_back({a, b, c});  // a T-junction: two triangles meet the side of one, in the middle of it
  soup.push_back({a, middle, d});
  soup.push_back({middle, b, d});
  soup.push_back({a, c, d});  // and a concave corner
  return soup;
}

TEST(SweptSphereOracle, EarliestHitInASoup) {
  const int n_soups = full_run() ? 5000 : 100, n_sweeps = 100;
  int n_hits = 0;
  for (int k = 0; k < n_soups; ++k) {
    Cases cases(1000 + static_cast<std::uint64_t>(k));
    const std::vector<Simplex<3>> soup = make_soup(cases);
    const SimplexBvh<3> bvh(soup);
    for (int trial = 0; trial < n_sweeps; ++trial) {
      const Sweep s = sweep_at(cases, soup[static_cast<std::size_t>(cases.one_of(static_cast<int>(soup.size())))]);
      const auto first = bvh.first_contact(s.centre, s.displacement, s.radius);
      const double time = first ? first->contact.time : std::numeric_limits<double>::infinity();
      n_hits += time <= 1.0;

      // Every triangle, near or not.
      const double delta = tolerance(s, 3.0);
      double earliest = std::numeric_limits<double>::infinity(), latest = earliest;
      bool touches = false;
      for (const Simplex<3>& t : soup) {
        const Passing<long double> passing(s.centre, s.displacement, t);
        earliest = std::min(earliest, oracle_time<long double>(passing, static_cast<long double>(s.radius) + delta));
        latest = std::min(
            latest, oracle_time<long double>(passing, std::max(static_cast<long double>(s.radius) - delta, 0.0L)));
        const auto start = static_cast<double>(passing.distance2(0));
        // As in expect_agreement: from on the triangle, or along it, its side is a matter of rounding.
        touches = touches || start <= delta * delta;
        touches = touches || (start <= s.radius * s.radius && passing.starts_along(delta / std::sqrt(start)));
        touches = touches ||
                  (start <= std::pow(s.radius + delta, 2) && start >= std::pow(std::max(s.radius - delta, 0.0), 2));
      }
      if (touches) continue;  // what touches at the start may be taken either way; OneTriangle looks into it
      ASSERT_LE(time, latest + 1e-15) << "soup " << k << " trial " << trial;
      ASSERT_GE(time, earliest - 1e-15) << "soup " << k << " trial " << trial;
    }
  }
  EXPECT_GT(n_hits, n_soups * n_sweeps / 4);
}

}  // namespace
}  // namespace smelt
