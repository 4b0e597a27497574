#include "core/geometry/swept_sphere.h"

#include "core/geometry/simplex_bvh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace smelt {
namespace {

const Simplex<3> triangle = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};

TEST(SweepSphere, HitsTheFaceAtTheRightTime) {
  const auto contact = sweep_sphere<3>(Vec3(0.2, 0.2, 1.0), Vec3(0, 0, -2.0), 0.1, triangle);
  ASSERT_TRUE(contact);
  EXPECT_NEAR(contact->time, 0.45, 1e-14);
  EXPECT_NEAR((contact->normal - Vec3(0, 0, 1)).norm(), 0.0, 1e-14);
  // From behind as well: triangles are two-sided.
  const auto behind = sweep_sphere<3>(Vec3(0.2, 0.2, -1.0), Vec3(0, 0, 2.0), 0.1, triangle);
  ASSERT_TRUE(behind);
  EXPECT_NEAR(behind->normal[2], -1.0, 1e-14);
}

// [P 6-13] looks only at the moment the sphere meets the plane, and at feet of perpendiculars inside an edge: it misses
// both of these.
TEST(SweepSphere, GrazesAnEdgeAfterItTouchedThePlane) {
  // Slides along, just above the plane's level, and meets the edge y = 0 from outside.
  const auto contact = sweep_sphere<3>(Vec3(0.5, -1.0, 0.05), Vec3(0, 2.0, 0), 0.1, triangle);
  ASSERT_TRUE(contact);
  EXPECT_NEAR(contact->time, (1.0 - std::sqrt(0.01 - 0.0025)) / 2.0, 1e-12);
}

TEST(SweepSphere, HitsACornerHeadOn) {
  const auto contact = sweep_sphere<3>(Vec3(-1, -1, 0), Vec3(2, 2, 0), 0.2, triangle);
  ASSERT_TRUE(contact);
  EXPECT_NEAR(contact->time, (std::sqrt(2.0) - 0.2) / std::sqrt(8.0), 1e-12);
}

TEST(SweepSphere, IgnoresWhatItMovesAwayFrom) {
  EXPECT_FALSE(sweep_sphere<3>(Vec3(0.2, 0.2, 0.05), Vec3(0, 0, 1.0), 0.1, triangle));
  const auto deeper = sweep_sphere<3>(Vec3(0.2, 0.2, 0.05), Vec3(0, 0, -1.0), 0.1, triangle);
  ASSERT_TRUE(deeper);
  EXPECT_EQ(deeper->time, 0.0);
}

// Oracle: march the sphere in small steps and find when its distance to the triangle first falls below the radius.
TEST(SweepSphere, AgreesWithMarchingOnRandomTriangles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto point = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
  int n_hits = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    Simplex<3> t = {point(), point(), point()};
    if (trial % 5 == 0) t[2] = t[0] + 1e-3 * point() + 0.5 * (t[1] - t[0]);  // slivers
    if (trial % 50 == 0) t[2] = t[1];                                        // degenerate
    // Aimed somewhere near the triangle.
    const Vec3 centre = 2.0 * point(), displacement = 1.5 * (0.4 * t[0] + 0.6 * t[1] + 0.5 * point() - centre);
    const double radius = 0.05 + 0.2 * std::abs(uniform(random));
    if ((centre - closest_point<3>(centre, t)).norm() <= radius) continue;
    const auto contact = sweep_sphere<3>(centre, displacement, radius, t);
    double nearest = 1e30;
    constexpr int n_steps = 400;
    for (int k = 0; k <= n_steps; ++k) {
      const Vec3 at = centre + k * displacement / n_steps;
      const double distance = (at - closest_point<3>(at, t)).norm();
      nearest = std::min(nearest, distance);
      if (contact && k <= contact->time * n_steps - 1e-9) {
        ASSERT_GT(distance, radius * (1.0 - 1e-9)) << "penetrated before the contact, trial " << trial;
      }
    }
    if (!contact) {
      ASSERT_GT(nearest, radius * (1.0 - 1e-9)) << "missed a hit, trial " << trial;
    } else {
      const Vec3 at = centre + contact->time * displacement;
      ASSERT_NEAR((at - closest_point<3>(at, t)).norm(), radius, 1e-9)
          << "not touching at the contact, trial " << trial;
      ++n_hits;
    }
  }
  EXPECT_GT(n_hits, 300);
}

TEST(SweepSphere, CirclesMeetSegmentsIn2D) {
  const Simplex<2> segment = {Vec<2>(0, 0), Vec<2>(1, 0)};
  const auto face = sweep_sphere<2>(Vec<2>(0.5, 1.0), Vec<2>(0, -1.0), 0.25, segment);
  ASSERT_TRUE(face);
  EXPECT_NEAR(face->time, 0.75, 1e-14);
  const auto end = sweep_sphere<2>(Vec<2>(1.5, 0.0), Vec<2>(-1.0, 0.0), 0.25, segment);
  ASSERT_TRUE(end);
  EXPECT_NEAR(end->time, 0.25, 1e-14);
}

/// Simplices of every size, some twice and some without area, in a cube 20 wide at `place`.
template <int Dim>
std::vector<Simplex<Dim>> make_simplices(std::mt19937& random, std::size_t n, const Vec<Dim>& place) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto point = [&] { return Vec<Dim>(Vec<Dim>::NullaryExpr([&] { return uniform(random); })); };
  std::vector<Simplex<Dim>> simplices;
  while (simplices.size() < n) {
    Simplex<Dim> simplex;
    const Vec<Dim> at = place + 10.0 * point();
    const double size = std::pow(10.0, uniform(random) - 1.0);
    for (Vec<Dim>& corner : simplex) corner = at + size * point();
    if (simplices.size() % 9 == 0) simplex.back() = simplex.front();
    simplices.push_back(simplex);
    if (simplices.size() % 7 == 0) simplices.push_back(simplex);
  }
  simplices.resize(n);
  return simplices;
}

/// The first contact of all simplices but one, one by one.
template <int Dim>
std::optional<FirstContact<Dim>> sweep_all(const std::vector<Simplex<Dim>>& simplices, const Vec<Dim>& at,
                                           const Vec<Dim>& way, double radius, std::uint32_t except) {
  std::optional<FirstContact<Dim>> first;
  for (std::uint32_t k = 0; k < simplices.size(); ++k) {
    if (k == except) continue;
    const auto contact = sweep_sphere<Dim>(at, way, radius, simplices[k]);
    if (contact && (!first || contact->time < first->contact.time)) first = {k, *contact};
  }
  return first;
}

/// Queries of one set against all of its simplices one by one.
template <int Dim>
void test_queries(std::size_t n, const Vec<Dim>& place, int& n_hits) {
  std::mt19937 random(static_cast<unsigned>(8 + n));
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto point = [&] { return Vec<Dim>(Vec<Dim>::NullaryExpr([&] { return uniform(random); })); };
  const std::vector<Simplex<Dim>> simplices = make_simplices<Dim>(random, n, place);
  const SimplexBvh<Dim> bvh(simplices);
  for (int trial = 0; trial < 300; ++trial) {
    const std::string which = std::to_string(n) + " simplices, trial " + std::to_string(trial);
    const Vec<Dim> at = place + 11.0 * point();
    const double radius = std::pow(10.0, uniform(random) - 0.5);
    std::vector<std::uint32_t> near, found;
    double nearest = 10.0 * radius;
    std::uint32_t nearest_one = SimplexBvh<Dim>::none;
    for (std::uint32_t k = 0; k < n; ++k) {
      const double distance = (at - closest_point<Dim>(at, simplices[k])).norm();
      if (distance <= radius) near.push_back(k);
      if (distance < nearest) {
        nearest = distance;
        nearest_one = k;
      }
    }
    bvh.find_near(at, radius, found);
    EXPECT_EQ(found, near) << which;
    EXPECT_EQ(bvh.distance(at, 10.0 * radius), nearest) << which;
    const auto nearest_found = bvh.nearest(at, 10.0 * radius);
    EXPECT_EQ(nearest_found ? nearest_found->simplex : SimplexBvh<Dim>::none, nearest_one) << which;

    Vec<Dim> way = 10.0 * std::pow(uniform(random), 3) * point();
    if (trial % 5 == 0) way = way.cwiseProduct(Vec<Dim>::Unit(trial / 5 % Dim));  // along an axis
    std::uint32_t except = SimplexBvh<Dim>::none;
    for (int round = 0; round < 2; ++round) {  // then without what was hit first
      const auto first = sweep_all<Dim>(simplices, at, way, radius, except);
      const auto contact = bvh.first_contact(at, way, radius, except);
      ASSERT_EQ(contact.has_value(), first.has_value()) << which;
      if (!contact) break;
      EXPECT_EQ(contact->simplex, first->simplex) << which;
      EXPECT_EQ(contact->contact.time, first->contact.time) << which;
      EXPECT_EQ(contact->contact.normal, first->contact.normal) << which;
      except = first->simplex;
      ++n_hits;
    }
  }
}

/// Bumpy ground of n x n cells of two triangles over [0, 1]^2.
std::vector<Simplex<3>> bumpy_ground(int n) {
  const auto at = [&](int i, int k) {
    const double x = static_cast<double>(i) / n, z = static_cast<double>(k) / n;
    return Vec3(x, 0.01 * std::sin(40.0 * x) * std::cos(30.0 * z), z);
  };
  std::vector<Simplex<3>> facets;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      facets.push_back({at(i, k), at(i, k + 1), at(i + 1, k + 1)});
      facets.push_back({at(i, k), at(i + 1, k + 1), at(i + 1, k)});
    }
  return facets;
}

/// Mean visits of spheres that fall on ground whose triangles are as large as they are, so that each meets as many.
double mean_nodes_visited(int n_cells) {
  const SimplexBvh<3> bvh(bumpy_ground(n_cells));
  const double radius = 0.5 / n_cells;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> inside(0.1, 0.9);
  double nodes = 0.0;
  constexpr int n_spheres = 2000;
  for (int k = 0; k < n_spheres; ++k) {
    const Vec3 foot(inside(random), 0.0, inside(random));
    const double ground = bvh.nearest(foot, 1.0)->offset[1];
    const Vec3 centre = foot + Vec3(0.0, -ground + 2.0 * radius, 0.0);
    nodes += static_cast<double>(bvh.count_visits(centre, Vec3(radius, -2.0 * radius, 0.0), radius));
  }
  return nodes / n_spheres;
}

TEST(SimplexBvh, VisitsGrowWithTheLogOfTheTriangles) {
  // 200 triangles to half a million: 8 of them a node, so that each step, 16 times as many, is a level and a third.
  const double visits[] = {mean_nodes_visited(10), mean_nodes_visited(40), mean_nodes_visited(160),
                           mean_nodes_visited(500)};
  for (int k = 0; k < 3; ++k) EXPECT_LT(visits[k + 1] - visits[k], 2.0) << k;
  EXPECT_LT(visits[3], 12.0);
}

TEST(SimplexBvh, AnswersAreThoseOfEverySimplexToTheBit) {
  int n_hits = 0;
  for (const std::size_t n : {0, 1, 8, 9, 65, 700, 3000}) {
    test_queries<3>(n, Vec3::Zero(), n_hits);
    test_queries<3>(n, Vec3(3e3, -1e4, 2e3), n_hits);
    test_queries<2>(n, Vec<2>(-1.0, 1e3), n_hits);
    test_queries<1>(n, Vec<1>(7.0), n_hits);
  }
  EXPECT_GT(n_hits, 2000);
}

}  // namespace
}  // namespace smelt
