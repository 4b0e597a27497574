// Spheres swept by obstacles that turn, slide and close in: none changes sides, at any speed.

#include "core/sph/collision.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace smelt {
namespace {

constexpr double pi = std::numbers::pi;

/// A regular polygon around the origin, wound so that its outside is out.
std::vector<Simplex<2>> polygon(int n, double radius) {
  std::vector<Simplex<2>> segments;
  const auto corner = [&](int k) {
    return Vec<2>(radius * std::cos(2 * pi * k / n), radius * std::sin(2 * pi * k / n));
  };
  for (int k = 0; k < n; ++k) segments.push_back({corner(k), corner(k + 1)});
  return segments;
}

/// A prism along z, with lids: a drum.
std::vector<Simplex<3>> prism(int n, double radius, double half_length) {
  std::vector<Simplex<3>> facets;
  const auto corner = [&](int k, double z) {
    return Vec3(radius * std::cos(2 * pi * k / n), radius * std::sin(2 * pi * k / n), z);
  };
  for (int k = 0; k < n; ++k) {
    facets.push_back({corner(k, -half_length), corner(k + 1, -half_length), corner(k + 1, half_length)});
    facets.push_back({corner(k, -half_length), corner(k + 1, half_length), corner(k, half_length)});
    for (const double z : {-half_length, half_length})
      facets.push_back({Vec3(0, 0, z), corner(k, z), corner(k + 1, z)});
  }
  return facets;
}

struct Dust {
  Vec3 x, v;
};

/// Random dust in the box, as fast as `speed`.
std::vector<Dust> make_dust(int n, const Vec3& half, double speed) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Dust> dust;
  for (int i = 0; i < n; ++i) {
    const Vec3 x = half.cwiseProduct(Vec3(uniform(random), uniform(random), uniform(random)));
    dust.push_back({x, speed * Vec3(uniform(random), uniform(random), uniform(random))});
  }
  return dust;
}

/// Moves all of it a step under gravity.
void advance(Colliders<3>& colliders, double radius, double time, double dt, std::vector<Dust>& dust) {
  colliders.begin_step(time, dt);
  for (Dust& d : dust) {
    d.v[1] -= 9.81 * dt;
    Vec3 transport = d.v;
    colliders.move_sphere(radius, dt, d.x, transport, d.v);
  }
  colliders.end_step();
}

// A plug that has vanished neither falls on nor bounds the step.
TEST(MovingColliders, WhatHasVanishedMovesNoMore) {
  for (const bool rigid : {false, true}) {
    Obstacle<3> plug;
    plug.facets = prism(8, 1.0, 1.0);
    plug.until = 0.5;
    if (rigid)
      plug.mass = 10.0;
    else
      plug.motion.velocity = Vec3(0, -3, 0);
    Colliders<3> colliders;
    colliders.add(std::move(plug));
    colliders.place_at(0.0);
    constexpr double dt = 0.1;
    for (int k = 0; k < 10; ++k) {
      const double time = k * dt;
      if (k == 4) {
        EXPECT_GT(colliders.speed_bound(time, time + dt), 2.9);
      }
      colliders.kick_bodies(Vec3(0, -9.81, 0), dt);
      colliders.begin_step(time, dt);
      EXPECT_EQ(colliders.step_way() > 0.0, k < 5) << k;
      colliders.end_step();
    }
    EXPECT_EQ(colliders.speed_bound(1.0, 1.1), 0.0);
  }
}

// A drum, turning about an axis of its own that it is carried along, with a paddle in it fixed to the world: the rim
// passes the dust by up to twelve radii a step.
TEST(MovingColliders, ADrumAndAPaddleHoldDust) {
  constexpr double radius = 0.02, dt = 0.01;
  for (const bool wall : {false, true})
    for (const ContactResponse response :
         {ContactResponse{0.0, 0.0}, ContactResponse{1.0, 0.0}, ContactResponse{0.5, 0.8}})
      for (const double spin : {1.0, 25.0}) {
        Obstacle<3> drum;
        drum.facets = prism(24, 1.0, 0.5);
        drum.response = response;
        drum.wall = wall;
        drum.motion.spin = to_skew(Vec3(0.1 * spin, 0.0, spin));
        drum.motion.velocity = Vec3(0.3, 0.0, 0.1);
        Obstacle<3> paddle;
        paddle.facets = {{Vec3(-0.5, -0.1, -9), Vec3(0.5, 0.1, -9), Vec3(0.5, 0.1, 9)},
                         {Vec3(-0.5, -0.1, -9), Vec3(0.5, 0.1, 9), Vec3(-0.5, -0.1, 9)}};
        paddle.response = response;
        paddle.motion.velocity = drum.motion.velocity;
        Colliders<3> colliders;
        colliders.add(drum);
        colliders.add(paddle);
        colliders.place_at(0.0);
        std::vector<Dust> dust = make_dust(12, Vec3(0.6, 0.6, 0.4), 3.0);
        const auto lost = [&] {
          int n = 0;
          for (const Dust& d : dust) {
            const Vec3 local = colliders.placed()[0].begin.to_rest(d.x);
            if (std::abs(local[2]) > 0.5 || std::hypot(local[0], local[1]) > 1.0) ++n;
            for (const auto& facet : drum.facets)
              if ((local - closest_point<3>(local, facet)).norm() < 1e-4 * radius) ++n;
          }
          return n;
        };
        for (int step = 0; step < 300; ++step) {
          advance(colliders, radius, step * dt, dt, dust);
          ASSERT_EQ(lost(), 0) << "step " << step << " spin " << spin << " friction " << response.friction << " wall "
                               << wall;
        }
      }
}

// What sticks to a wheel goes round with it: omega r for ever, at a third of a turn a step or a thousandth.
TEST(MovingColliders, WhatSticksTurnsWithIt) {
  for (const double turn : {0.006, 0.3, 2.0}) {
    Obstacle<2> drum;
    drum.facets = polygon(64, 1.0);
    drum.motion.spin = to_skew(turn);
    Colliders<2> colliders;
    colliders.add(drum);
    colliders.place_at(0.0);
    constexpr double radius = 0.05;
    Vec<2> x(0.2, -0.7), v(0.0, -2.0);
    for (int step = 0; step < 1000; ++step) {
      colliders.begin_step(step, 1.0);
      Vec<2> transport = v;
      colliders.move_sphere(radius, 1.0, x, transport, v);
      colliders.end_step();
      if (step < 5) continue;
      EXPECT_NEAR((v - to_skew(turn) * x).norm(), 0.0, 1e-9 * turn);
    }
    const Vec<2> local = colliders.placed()[0].begin.to_rest(x);
    double nearest = 1.0;
    for (const auto& segment : drum.facets)
      nearest = std::min(nearest, (local - closest_point<2>(local, segment)).norm());
    EXPECT_NEAR(nearest, radius, 1e-9);
  }
}

// A press comes down on dust in a bucket to a gap of one and a half radii, six radii a step: dust is squeezed to its
// very sides but stays between.
TEST(MovingColliders, APressSqueezesDustFlat) {
  constexpr double radius = 0.02, dt = 0.01;
  for (const bool smooth : {false, true}) {
    Obstacle<3> bucket;
    bucket.facets = {{Vec3(-9, 0, -9), Vec3(-9, 0, 9), Vec3(9, 0, 9)},
                     {Vec3(-9, 0, -9), Vec3(9, 0, 9), Vec3(9, 0, -9)}};
    Obstacle<3> press = bucket;
    press.motion.smooth = smooth;
    press.motion.keyframes = {{0.0, Vec3(0, 1, 0), Mat3::Identity()},
                              {0.08, Vec3(0, 1.5 * radius, 0), Mat3::Identity()},
                              {0.2, Vec3(0, 1, 0), rotation_of<3>(to_skew(Vec3(0, 0, 0.05)))},
                              {0.3, Vec3(0, 1.0 * radius, 0), Mat3::Identity()}};
    Colliders<3> colliders;
    colliders.add(bucket);
    colliders.add(press);
    colliders.place_at(0.0);
    std::vector<Dust> dust = make_dust(40, Vec3(0.5, 0.45, 0.5), 5.0);
    for (Dust& d : dust) d.x[1] += 0.5;
    for (int step = 0; step < 60; ++step) {
      advance(colliders, radius, step * dt, dt, dust);
      for (const Dust& d : dust) {
        ASSERT_GT(d.x[1], 0.0) << step;
        ASSERT_LT(colliders.placed()[1].begin.to_rest(d.x)[1], 0.0) << step;
      }
    }
  }
}

}  // namespace
}  // namespace smelt
