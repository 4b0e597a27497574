#include "core/sph/rigid_body.h"

#include "core/error.h"
#include "core/sph/collision.h"
#include "tests/bodies.h"

#include <gtest/gtest.h>

#include <cmath>

namespace smelt {
namespace {

Vec3 angular_momentum(const RigidBody<3>& body) {
  return from_skew(body.state.angular_momentum);
}

TEST(RigidBody, SpinOfABrickIsMomentumOverItsMoments) {
  const RigidBody<3> body = make_rigid_body<3>(make_brick(Vec3(0, 0, 0), Vec3(1, 2, 3)), 12.0);
  EXPECT_NEAR((body.rest_centre - Vec3(0.5, 1, 1.5)).norm(), 0.0, 1e-14);
  // I_xx = m (b^2 + c^2)/12 and so on.
  const Vec3 inertia(4 + 9, 1 + 9, 1 + 4), omega(0.3, -0.2, 0.9);
  const Mat3 l = to_skew(Vec3(inertia.cwiseProduct(omega)));
  EXPECT_NEAR((from_skew(body.spin_of(l)) - omega).norm(), 0.0, 1e-14);
  RigidBody<3> turning = body;
  turning.state.angular_momentum = l;
  EXPECT_NEAR(turning.kinetic_energy(), 0.5 * omega.dot(inertia.cwiseProduct(omega)), 1e-13);
}

TEST(RigidBody, AnImpulseDoesWhatItsComplianceSays) {
  RigidBody<3> body = make_rigid_body<3>(make_brick(Vec3(0, 0, 0), Vec3(1, 2, 3)), 12.0);
  body.state.rotation = rotation_of<3>(to_skew(Vec3(0.4, 0.1, -0.7)));
  const Vec3 x(1.0, 0.5, 2.5), n = Vec3(1, -1, 2).normalized();
  const double compliance = body.compliance(x, n);
  body.strike(x, 0.7 * n);
  EXPECT_NEAR(body.velocity_at(x).dot(n), 0.7 * compliance, 1e-14);
  EXPECT_GE(body.compliance_bound(x), compliance);
  EXPECT_NEAR((angular_momentum(body) - (x - body.state.centre).cross(Vec3(0.7 * n))).norm(), 0.0, 1e-14);
}

// A brick spun about its middle axis tumbles over; its momentum stays to the last bit, its energy to second order.
TEST(RigidBody, FreeTumblingKeepsMomentumAndEnergy) {
  const auto drift_of_energy = [](double dt) {
    RigidBody<3> body = make_rigid_body<3>(make_brick(Vec3(0, 0, 0), Vec3(1, 2, 3)), 12.0);
    body.state.angular_momentum = to_skew(Vec3(0.05, 20.0, 0.05));
    const double before = body.kinetic_energy();
    double worst = 0.0, least = 1.0;
    for (double t = 0.0; t < 20.0; t += dt) {
      const BodyState<3> after = drift_body(body, dt);
      EXPECT_EQ(after.angular_momentum, body.state.angular_momentum);
      body.state = after;
      worst = std::max(worst, std::abs(body.kinetic_energy() / before - 1.0));
      least = std::min(least, body.state.rotation(1, 1));
    }
    EXPECT_LT(least, -0.5) << "it turns over";
    return worst;
  };
  const double coarse = drift_of_energy(0.02), fine = drift_of_energy(0.01);
  EXPECT_LT(fine, 1e-3);
  EXPECT_GT(coarse / fine, 3.0);
}

TEST(RigidBody, WhatBoundsNoVolumeIsRefused) {
  auto facets = make_brick(Vec3(0, 0, 0), Vec3(1, 2, 3));
  EXPECT_THROW(make_rigid_body<3>(facets, 0.0), Error);
  for (auto& f : facets) std::swap(f[0], f[1]);
  EXPECT_THROW(make_rigid_body<3>(facets, 1.0), Error);
}

// ------------------------------------------------------------------------------------------------------------ contacts

template <int Dim>
Obstacle<Dim> make_body(std::vector<Simplex<Dim>> facets, double mass, const Vec<Dim>& velocity,
                        const ContactResponse& response) {
  Obstacle<Dim> body;
  body.facets = std::move(facets);
  body.closed = true;
  body.mass = mass;
  body.motion.velocity = velocity;
  body.response = response;
  return body;
}

Obstacle<3> make_floor(const ContactResponse& response) {
  Obstacle<3> floor;
  floor.facets = {{Vec3(-99, 0, -99), Vec3(-99, 0, 99), Vec3(99, 0, 99)},
                  {Vec3(-99, 0, -99), Vec3(99, 0, 99), Vec3(99, 0, -99)}};
  floor.response = response;
  return floor;
}

/// Leap-frog of bodies alone.
template <int Dim>
void advance(Colliders<Dim>& colliders, const Vec<Dim>& gravity, double time, double dt) {
  colliders.kick_bodies(gravity, 0.5 * dt);
  colliders.begin_step(time, dt);
  colliders.end_step();
  colliders.kick_bodies(gravity, 0.5 * dt);
}

template <int Dim>
double lowest(const PlacedObstacle<Dim>& placed) {
  double y = 1e9;
  for (const auto& corner : placed.corners) y = std::min(y, placed.begin.to_world(corner)[1]);
  return y;
}

// At up to three times its size a step a body does not fall through a floor; nor a brick on its corner.
TEST(BodyContacts, NothingFallsThroughTheFloor) {
  for (const double speed : {1.0, 30.0, 300.0})
    for (const bool brick : {false, true})
      for (const ContactResponse response : {ContactResponse{0.0, 0.0}, ContactResponse{1.0, 0.5}}) {
        Colliders<3> colliders;
        colliders.add(make_floor({0.0, 0.0}));
        auto facets = brick ? make_brick(Vec3(-0.5, 3, -0.5), Vec3(0.5, 4, 0.5)) : make_sphere(4, 0.5, Vec3(0, 3, 0));
        auto body = make_body<3>(facets, 2.0, Vec3(0.3 * speed, -speed, 0), response);
        if (brick) body.motion.spin = to_skew(Vec3(3.0, 1.0, 2.0));
        colliders.add(body);
        colliders.place_at(0.0);
        for (int step = 0; step < 400; ++step) {
          advance<3>(colliders, Vec3(0, -9.81, 0), 0.01 * step, 0.01);
          ASSERT_GT(lowest(colliders.placed()[1]), 0.0) << "speed " << speed << " step " << step << " brick " << brick;
        }
        const double rise = std::abs(colliders.placed()[1].body->state.velocity[1]);
        // What struck at 300 m/s still tumbles, or rolls at 60 m/s from corner to corner, after four seconds.
        EXPECT_TRUE(response.restitution > 0.0 || speed > 100.0 || rise < 0.2)
            << "speed " << speed << " brick " << brick << ": " << rise;
      }
}

TEST(BodyContacts, RestitutionReturnsItsShareOfTheSpeed) {
  for (const double restitution : {0.0, 0.3, 1.0}) {
    Colliders<3> colliders;
    colliders.add(make_floor({1.0, 0.0}));
    colliders.add(make_body<3>(make_sphere(4, 0.5, Vec3(0, 1, 0)), 2.0, Vec3(0, -4, 0), {1.0, restitution}));
    colliders.place_at(0.0);
    for (int step = 0; step < 40; ++step) advance<3>(colliders, Vec3::Zero(), 0.01 * step, 0.01);
    EXPECT_NEAR(colliders.placed()[1].body->state.velocity[1], 4.0 * restitution, 1e-6);
  }
}

// A wheel that lands on no-slip ground rolls: of its speed v a disc keeps 2/3 (1/(1 + I/m r^2)).
TEST(BodyContacts, ADiscThatSticksRolls) {
  Colliders<2> colliders;
  Obstacle<2> floor;
  floor.facets = {{Vec<2>(99, 0), Vec<2>(-99, 0)}};
  colliders.add(floor);
  colliders.add(make_body<2>(make_polygon(256, 0.5, Vec<2>(0, 0.55)), 2.0, Vec<2>(3, -0.3), {0.0, 0.0}));
  colliders.place_at(0.0);
  for (int step = 0; step < 100; ++step) advance<2>(colliders, Vec<2>(0, -9.81), 0.005 * step, 0.005);
  const RigidBody<2>& body = *colliders.placed()[1].body;
  EXPECT_NEAR(body.state.velocity[0], 2.0, 0.06);
  EXPECT_NEAR(body.spin()(1, 0), -4.0, 0.15);
}

// Two bodies that meet keep their momentum to rounding, and a heavy one drives the light one off.
TEST(BodyContacts, ABlowBetweenBodiesKeepsMomentum) {
  Colliders<3> colliders;
  colliders.add(make_body<3>(make_sphere(4, 0.5, Vec3(0, 0, 0)), 2.0, Vec3(4, 0, 0), {1.0, 1.0}));
  colliders.add(make_body<3>(make_sphere(3, 0.4, Vec3(2, 0.2, 0.1)), 0.5, Vec3(-1, 0, 0), {1.0, 1.0}));
  colliders.place_at(0.0);
  const auto sums = [&] {
    Vec3 p = Vec3::Zero(), l = Vec3::Zero();
    double e = 0.0;
    for (const auto& placed : colliders.placed()) {
      const RigidBody<3>& b = *placed.body;
      p += b.mass * b.state.velocity;
      l += angular_momentum(b) + b.state.centre.cross(Vec3(b.mass * b.state.velocity));
      e += b.kinetic_energy();
    }
    return std::tuple(p, l, e);
  };
  const auto [p, l, e] = sums();
  for (int step = 0; step < 100; ++step) advance<3>(colliders, Vec3::Zero(), 0.01 * step, 0.01);
  const auto [p1, l1, e1] = sums();
  EXPECT_NEAR((p1 - p).norm(), 0.0, 1e-12);
  EXPECT_NEAR((l1 - l).norm(), 0.0, 0.02 * l.norm())
      << "the corner strikes a skin's and a step's way before it touches";
  EXPECT_LE(e1, e * (1.0 + 1e-6)) << "to what thirty sweeps leave";
  EXPECT_GT(e1, 0.8 * e);
  EXPECT_GT(colliders.placed()[1].body->state.velocity[0], 2.0);
}

// A press that moves by itself pushes a body before it.
TEST(BodyContacts, APistonPushesABody) {
  Colliders<3> colliders;
  Obstacle<3> piston = make_floor({0.0, 0.0});
  piston.motion.velocity = Vec3(0, 2, 0);
  colliders.add(piston);
  colliders.add(make_body<3>(make_sphere(4, 0.5, Vec3(0, 1, 0)), 2.0, Vec3::Zero(), {0.0, 0.0}));
  colliders.place_at(0.0);
  for (int step = 0; step < 100; ++step) advance<3>(colliders, Vec3::Zero(), 0.01 * step, 0.01);
  EXPECT_NEAR(colliders.placed()[1].body->state.velocity[1], 2.0, 1e-6);
  EXPECT_GT(lowest(colliders.placed()[1]), 2.0);
}

}  // namespace
}  // namespace smelt
