#include "core/sph/collision.h"

#include <gtest/gtest.h>

#include <random>

namespace smelt {
namespace {

Colliders<3> floor_with(const ContactResponse& response) {
  Colliders<3> colliders;
  colliders.add(
      {{{Vec3(-9, 0, -9), Vec3(-9, 0, 9), Vec3(9, 0, 9)}, {Vec3(-9, 0, -9), Vec3(9, 0, 9), Vec3(9, 0, -9)}}, response});
  return colliders;
}

TEST(Collision, RestitutionAndFrictionScaleTheComponents) {
  const Colliders<3> floor = floor_with({0.5, 0.25});
  Vec3 x(0, 1.0, 0), v(2.0, -4.0, 0);
  Vec3 transport = v;
  EXPECT_TRUE(floor.move_sphere(0.5, 0.25, x, transport, v));
  EXPECT_NEAR((v - Vec3(1.0, 1.0, 0)).norm(), 0.0, 1e-13);
  // Contact after 1/8 s at x = 0.25; the other 1/8 s goes on with the new velocity.
  EXPECT_NEAR((x - Vec3(0.25 + 0.125, 0.5 + 0.125, 0)).norm(), 0.0, 1e-13);
}

TEST(Collision, NoSlipStops) {
  const Colliders<3> floor = floor_with({0.0, 0.0});
  Vec3 x(0, 0.5, 0), v(2.0, -1.0, 0.3);
  Vec3 transport = v;
  EXPECT_TRUE(floor.move_sphere(0.5, 0.1, x, transport, v));
  EXPECT_EQ(v.norm(), 0.0);
  EXPECT_NEAR(x[1], 0.5, 1e-14);
}

TEST(Collision, OverlapIsPushedOut) {
  const Colliders<3> floor = floor_with({0.0, 0.0});
  Vec3 x(0, 0.1, 0), v = Vec3::Zero();
  Vec3 transport = v;
  floor.move_sphere(0.5, 0.1, x, transport, v);
  EXPECT_NEAR(x[1], 0.5, 1e-14);
}

// Which side a centre on the facet itself belongs to, nothing says: the front's.
TEST(Collision, ACentreOnAFacetGoesToItsFront) {
  const Colliders<3> floor = floor_with({0.0, 0.0});
  Vec3 x(0.3, 0.0, 0.1), v = Vec3::Zero();
  Vec3 transport = v;
  floor.move_sphere(0.5, 0.1, x, transport, v);
  EXPECT_NEAR((x - Vec3(0.3, 0.5, 0.1)).norm(), 0.0, 1e-14);
}

// A wedge too narrow for the sphere: it is pushed about, but never to the other side.
TEST(Collision, PushingOutOfOneFacetDoesNotPassAnother) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Colliders<3> wedge;
  Obstacle<3> sides;
  for (const double y : {-1.0, 1.0}) {
    sides.facets.push_back({Vec3(0, 0, -9), Vec3(0, 0, 9), Vec3(9, y, 9)});
    sides.facets.push_back({Vec3(0, 0, -9), Vec3(9, y, 9), Vec3(9, y, -9)});
  }
  wedge.add(sides);
  for (int trial = 0; trial < 1000; ++trial) {
    Vec3 x(0.1 + 3.0 * uniform(random), 0.0, uniform(random));
    x[1] = (2.0 * uniform(random) - 1.0) * 0.999 * x[0] / 9.0;
    Vec3 v = Vec3::Zero();
    for (int step = 0; step < 5; ++step) {
      Vec3 transport = v;
      wedge.move_sphere(0.5, 0.1, x, transport, v);
      ASSERT_LT(std::abs(x[1]), x[0] / 9.0) << "trial " << trial << " step " << step;
    }
  }
}

/// A cube of side 2 around the origin, faces in two triangles each.
Colliders<3> box(const ContactResponse& response) {
  std::vector<Simplex<3>> triangles;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const auto corner = [&](double u, double v) {
        Vec3 p;
        p[axis] = side;
        p[(axis + 1) % 3] = u;
        p[(axis + 2) % 3] = v;
        return p;
      };
      triangles.push_back({corner(-1, -1), corner(1, -1), corner(1, 1)});
      triangles.push_back({corner(-1, -1), corner(1, 1), corner(-1, 1)});
    }
  Colliders<3> colliders;
  colliders.add({std::move(triangles), response});
  return colliders;
}

TEST(Collision, ABoxHoldsWhatBouncesInIt) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Colliders<3> walls = box({1.0, 1.0});
  constexpr double radius = 0.05;
  for (int particle = 0; particle < 200; ++particle) {
    Vec3 x(0.9 * uniform(random), 0.9 * uniform(random), 0.9 * uniform(random));
    // Up to forty radii a step, corners and edges included.
    Vec3 v(2.0 * uniform(random), 2.0 * uniform(random), 2.0 * uniform(random));
    const double speed = v.norm();
    for (int step = 0; step < 300; ++step) {
      Vec3 transport = v;
      walls.move_sphere(radius, 1.0, x, transport, v);
      ASSERT_LE(x.cwiseAbs().maxCoeff(), 1.0 - radius * (1.0 - 1e-9)) << "particle " << particle << " step " << step;
      ASSERT_NEAR(v.norm(), speed, 1e-9 * speed) << "elastic walls keep the speed";
    }
  }
}

}  // namespace
}  // namespace smelt
