// Rigid bodies in a fluid: both ways.

#include "bench/cases/set_up.h"
#include "core/parallel.h"
#include "core/sph/solver.h"
#include "tests/bodies.h"

#include <gtest/gtest.h>

#include <cmath>

namespace smelt {
namespace {

constexpr double density = 1000.0;

Obstacle<2> make_body(std::vector<Simplex<2>> facets, double mass) {
  Obstacle<2> body;
  body.facets = std::move(facets);
  body.wall = body.closed = true;
  body.mass = mass;
  return body;
}

struct Sums {
  Vec<2> momentum = Vec<2>::Zero();
  double angular = 0.0;
  double energy = 0.0;
};

double cross(const Vec<2>& a, const Vec<2>& b) {
  return a[0] * b[1] - a[1] * b[0];
}

Sums sum_up(const Solver<2, double>& solver) {
  Sums sums;
  const auto add = [&](double m, const Vec<2>& x, const Vec<2>& v) {
    sums.momentum += m * v;
    sums.angular += m * cross(x, v);
    sums.energy += 0.5 * m * v.squaredNorm();
  };
  for (std::size_t i = 0; i < solver.particles().size(); ++i)
    add(solver.mass(i), solver.particles().position[i], solver.particles().velocity[i]);
  for (const auto& placed : solver.colliders().placed()) {
    if (!placed.body) continue;
    const BodyState<2>& state = placed.body->state;
    add(placed.body->mass, state.centre, state.velocity);
    sums.angular += state.angular_momentum(1, 0);
    sums.energy += placed.body->kinetic_energy() - 0.5 * placed.body->mass * state.velocity.squaredNorm();
  }
  return sums;
}

/// A body flies into a drop of viscous fluid, off its middle, free of everything else.
Solver<2, double> make_blow(double density_ratio, double speed, double viscosity,
                            const Solver<2, double>* from = nullptr) {
  constexpr double spacing = 0.05;
  auto parameters = make_parameters<2>(spacing, 60.0);
  parameters.artificial_viscosity = 0.3;
  parameters.hourglass_control = 1.0;
  parameters.xsph = 0.3;
  Particles<2> drop = make_ball<2>(0.5, spacing, density);
  Obstacle<2> body = make_body(make_polygon(24, 0.2, Vec<2>(-0.78, 0.15)), density_ratio * density * 0.1242);
  body.motion.velocity = Vec<2>(speed, 0.0);
  body.motion.spin = to_skew(3.0);
  Colliders<2> colliders;
  colliders.add(body);
  if (from) {
    drop = from->particles();
    colliders.set_body_states(from->colliders().body_states());
  }
  Solver<2, double> solver(parameters,
                           {viscosity > 0.0 ? newtonian_material(density, viscosity) : inviscid_material(density)},
                           std::move(colliders), std::move(drop));
  solver.prepare();
  return solver;
}

// Body and fluid together keep their momentum to rounding, light bodies and heavy, where walls push and where the guard
// is hit.
TEST(FloatingBody, FluidAndBodyTogetherKeepTheirMomentum) {
  for (const double ratio : {0.1, 1.0, 8.0})
    for (const double speed : {3.0, 30.0})
      for (const double viscosity : {0.0, 5.0}) {
        Solver<2, double> solver = make_blow(ratio, speed, viscosity);
        const Sums before = sum_up(solver);
        const double scale = before.momentum.norm();
        advance_by(solver, 0.6 / speed);
        const Sums after = sum_up(solver);
        EXPECT_LT((after.momentum - before.momentum).norm(), 1e-9 * scale) << ratio << " " << speed;
        EXPECT_LT(std::abs(after.angular - before.angular), 0.01 * scale * 0.5) << ratio << " " << speed;
        EXPECT_LT(after.energy, before.energy) << "energy from nowhere";
        EXPECT_LT(solver.colliders().placed()[0].body->state.velocity[0], 0.95 * speed) << "it was pushed back";
        for (const Vec<2>& x : solver.particles().position)
          EXPECT_GT((x - solver.colliders().placed()[0].body->state.centre).norm(),
                    0.2 * std::cos(std::numbers::pi / 24))
              << "inside the body";
      }
}

// The states of particles and bodies are all that a step needs.
TEST(FloatingBody, ResumeFromStateAloneIsExact) {
  const auto frame = [](Solver<2, double>& solver, double from) {
    solver.prepare(from);
    for (double t = 0.0; t < 0.02;) t += solver.step(0.02 - t, from + t).dt;
  };
  Solver<2, double> whole = make_blow(0.5, 10.0, 5.0);
  frame(whole, 0.0);
  Solver<2, double> resumed = make_blow(0.5, 10.0, 5.0, &whole);
  frame(whole, 0.02);
  frame(resumed, 0.02);
  ASSERT_EQ(whole.particles().position, resumed.particles().position);
  const BodyState<2> a = whole.colliders().body_states()[0], b = resumed.colliders().body_states()[0];
  ASSERT_EQ(a.centre, b.centre);
  ASSERT_EQ(a.rotation, b.rotation);
  ASSERT_EQ(a.velocity, b.velocity);
  ASSERT_EQ(a.angular_momentum, b.angular_momentum);
  EXPECT_LT(a.velocity[0], 9.5) << "it has hit something meanwhile";
}

/// A ball or raft in a tank, left alone till it floats.
void test_floating(std::vector<Simplex<2>> facets, double area, double ratio, double expected_centre_depth,
                   double start_y) {
  constexpr double spacing = 0.025, width = 1.2, depth = 0.5, g = 9.81;
  auto parameters = make_parameters<2>(spacing, 10.0 * std::sqrt(2.0 * g * depth));
  parameters.smoothing_length = 1.3 * spacing;
  parameters.gravity = Vec<2>(0.0, -g);
  parameters.artificial_viscosity = 0.3;
  parameters.density_diffusion = 0.1;
  parameters.courant = 0.4;
  Obstacle<2> body = make_body(facets, ratio * density * area);
  body.response.friction = 1.0;
  const double reach = 0.21;
  Particles<2> water = make_lattice<2>(
      {Vec<2>(0, 0), Vec<2>(width, depth)}, spacing, density, 0.0,
      [&](const Vec<2>& x) { return (x - Vec<2>(0.5 * width, start_y)).cwiseAbs().maxCoeff() > reach; });
  const double volume = static_cast<double>(water.size()) * spacing * spacing;
  Obstacle<2> tank;
  tank.wall = tank.closed = true;
  tank.response.friction = 1.0;
  const std::vector<Vec<2>> corners{Vec<2>(width, 9), Vec<2>(width, 0), Vec<2>(0, 0), Vec<2>(0, 9)};
  for (std::size_t k = 1; k < corners.size(); ++k) tank.facets.push_back({corners[k - 1], corners[k]});
  Colliders<2> colliders;
  colliders.add(tank);
  colliders.add(body);
  Solver<2, double> solver(parameters, {inviscid_material(density)}, std::move(colliders), std::move(water));
  solver.prepare();
  advance_by(solver, 2.0);
  double mean = 0.0;
  constexpr int n = 50;
  for (int k = 0; k < n; ++k) {
    advance_by(solver, 0.02);
    mean += solver.colliders().placed()[1].body->state.centre[1] / n;
  }
  // The level of the water that the body has raised: volume and what is under water fill the tank.
  const double level = (volume + ratio * area) / width, depth_of_centre = level - mean;
  // Measured: half a spacing, 4.2 % of the raft's height.
  EXPECT_NEAR(depth_of_centre, expected_centre_depth, 0.05 * 0.3) << ratio;
}

// Archimedes: a raft 0.4 m wide and 0.3 m high sinks to its share of density.
TEST(FloatingBody, ARaftDrawsItsDraught) {
  for (const double ratio : {0.5})
    test_floating(make_rectangle(Vec<2>(0.4, 0.2), Vec<2>(0.8, 0.5), 4), 0.12, ratio, (ratio - 0.5) * 0.3, 0.35);
}

}  // namespace
}  // namespace smelt
