#include "core/geometry/swept_sphere.h"

#include "core/geometry/simplex_bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

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

// [P 6-13] looks only at the moment the sphere meets the plane, and at feet of perpendiculars inside an edge: it misses both of these.
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
      ASSERT_NEAR((at - closest_point<3>(at, t)).norm(), radius, 1e-9) << "not touching at the contact, trial " << trial;
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

TEST(SimplexBvh, FindsAllThatAreNear) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto point = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
  std::vector<Simplex<3>> triangles;
  for (int k = 0; k < 2000; ++k) {
    const Vec3 at = 10.0 * point();
    triangles.push_back({at, at + point(), at + 0.3 * point()});
  }
  const SimplexBvh<3> bvh(triangles);
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 at = 10.0 * point();
    const double radius = std::abs(uniform(random));
    std::vector<std::uint32_t> found;
    bvh.find_near(at, radius, found);
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
    for (std::uint32_t k = 0; k < triangles.size(); ++k)
      if ((at - closest_point<3>(at, triangles[k])).norm() < radius) {
        ASSERT_TRUE(std::binary_search(found.begin(), found.end(), k)) << "triangle " << k << ", trial " << trial;
      }
  }
}

}  // namespace
}  // namespace smelt
