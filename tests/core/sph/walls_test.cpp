#include "core/sph/walls.h"

#include "core/geometry/facet.h"
#include "core/sph/solver.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace smelt {
namespace {

constexpr double spacing = 0.05, eta = 3.0;

template <int Dim>
Obstacle<Dim> make_plane(double y, bool facing_up = true) {
  Obstacle<Dim> plane;
  if constexpr (Dim == 2) {
    plane.facets = {{Vec<2>(9, y), Vec<2>(-9, y)}};
    if (!facing_up) std::swap(plane.facets[0][0], plane.facets[0][1]);
  } else {
    plane.facets = {{Vec3(-9, y, -9), Vec3(-9, y, 9), Vec3(9, y, 9)}, {Vec3(-9, y, -9), Vec3(9, y, 9), Vec3(9, y, -9)}};
    if (!facing_up)
      for (auto& facet : plane.facets) std::swap(facet[1], facet[2]);
  }
  plane.wall = true;
  return plane;
}

/// Rows of particles above y = 0, the first `offset` spacings up, in a box that repeats sideways.
template <int Dim>
Particles<Dim> make_layer(int n_rows, double offset) {
  Particles<Dim> p;
  for (int k = 0; k < (Dim == 3 ? 8 : 1); ++k)
    for (int j = 0; j < n_rows; ++j)
      for (int i = 0; i < 8; ++i) {
        Vec<Dim> x;
        x[0] = (i + 0.5) * spacing;
        x[1] = (j + offset) * spacing;
        if constexpr (Dim == 3) x[2] = (k + 0.5) * spacing;
        p.id.push_back(static_cast<std::int32_t>(p.id.size()));
        p.position.push_back(x);
        p.velocity.push_back(Vec<Dim>::Zero());
        p.density.push_back(1000.0);
      }
  return p;
}

template <int Dim>
SolverParameters<Dim> make_parameters() {
  SolverParameters<Dim> parameters;
  parameters.particle_volume = std::pow(spacing, Dim);
  parameters.smoothing_length = 1.2 * spacing;
  parameters.sound_speed = 20.0;
  parameters.period.lower = parameters.period.upper = Vec<Dim>::Zero();
  parameters.period.upper[0] = 8 * spacing;
  if constexpr (Dim == 3) parameters.period.upper[2] = 8 * spacing;
  return parameters;
}

Material make_fluid() {
  Material m{"oil", 1000.0, {}, std::nullopt};
  m.rheology.consistency = {eta, eta};
  return m;
}

template <int Dim>
Colliders<Dim> one(Obstacle<Dim> obstacle) {
  Colliders<Dim> colliders;
  colliders.add(std::move(obstacle));
  return colliders;
}

/// Greatest |S_xy - eta gamma| in simple shear over a wall that moves with `slide`.
template <int Dim>
double shear_error(double offset, double slide) {
  constexpr double gamma = 2.0;
  Particles<Dim> p = make_layer<Dim>(6, offset);
  for (std::size_t i = 0; i < p.size(); ++i) p.velocity[i][0] = slide + gamma * p.position[i][1];
  Obstacle<Dim> plane = make_plane<Dim>(0.0);
  plane.surface_velocity[0] = slide;
  Solver<Dim, double> solver(make_parameters<Dim>(), {make_fluid()}, one(std::move(plane)), std::move(p));
  solver.prepare();
  double worst = 0.0;
  for (const auto& s : solver.particles().stress) worst = std::max(worst, std::abs(s[Dim] - eta * gamma));
  return worst;
}

// What the wall adds makes the corrected gradient exact for a linear flow that sticks to it, wherever the rows stand.
TEST(Walls, SimpleShearIsExactAtAnyDistance) {
  for (const double offset : {0.3, 0.5, 0.77, 1.4}) {
    EXPECT_LT(shear_error<2>(offset, 0.0), 1e-11) << offset;
    EXPECT_LT(shear_error<2>(offset, 1.7), 1e-11) << offset;
    EXPECT_LT(shear_error<3>(offset, 0.0), 1e-11) << offset;
  }
}

TEST(Walls, FreeSlipCarriesNoShear) {
  Particles<2> p = make_layer<2>(6, 0.5);
  for (auto& v : p.velocity) v[0] = 3.0;
  Obstacle<2> plane = make_plane<2>(0.0);
  plane.response.friction = 1.0;
  Solver<2, double> solver(make_parameters<2>(), {make_fluid()}, one(std::move(plane)), std::move(p));
  solver.prepare();
  for (std::size_t i = 0; i < solver.particles().size(); ++i) EXPECT_NEAR(solver.acceleration(i)[0], 0.0, 1e-11);
}

// Seen from below, the same sheet is the same wall, whichever way it is wound.
TEST(Walls, ASheetHasTwoSides) {
  const auto accelerations = [](bool above, bool facing_up) {
    Particles<2> p = make_layer<2>(6, 0.5);
    for (std::size_t i = 0; i < p.size(); ++i) {
      p.velocity[i] = Vec<2>(1.0 - p.position[i][1], -0.3);
      p.density[i] = 1010.0;
      if (!above) {
        p.position[i][1] *= -1.0;
        p.velocity[i][1] *= -1.0;
      }
    }
    Solver<2, double> solver(make_parameters<2>(), {make_fluid()}, one(make_plane<2>(0.0, facing_up)), std::move(p));
    solver.prepare();
    std::vector<Vec<2>> by_id(solver.particles().size());
    for (std::size_t i = 0; i < by_id.size(); ++i)
      by_id[static_cast<std::size_t>(solver.particles().id[i])] = solver.acceleration(i);
    return by_id;
  };
  const auto above = accelerations(true, true);
  for (const bool facing_up : {true, false}) {
    const auto again = accelerations(true, facing_up), below = accelerations(false, facing_up);
    for (std::size_t i = 0; i < above.size(); ++i) {
      EXPECT_NEAR((again[i] - above[i]).norm(), 0.0, 1e-9 * (1.0 + above[i].norm()));
      EXPECT_NEAR((Vec<2>(below[i][0], -below[i][1]) - above[i]).norm(), 0.0, 1e-9 * (1.0 + above[i].norm()));
    }
  }
}

TEST(Walls, OnlyObstaclesThatAreWallsAddAnything) {
  const auto rise = [](bool wall) {
    Particles<2> p = make_layer<2>(6, 0.5);
    for (auto& rho : p.density) rho = 1010.0;
    Obstacle<2> plane = make_plane<2>(0.0);
    plane.wall = wall;
    Solver<2, double> solver(make_parameters<2>(), {make_fluid()}, one(std::move(plane)), std::move(p));
    solver.prepare();
    double lowest_row = 0.0;
    for (std::size_t i = 0; i < solver.particles().size(); ++i)
      if (solver.particles().position[i][1] < spacing) lowest_row = solver.acceleration(i)[1];
    return lowest_row;
  };
  // Pressed fluid leaves through an open side, and stays where a wall holds it up.
  EXPECT_LT(rise(false), -40.0);
  EXPECT_LT(std::abs(rise(true)), 0.1 * std::abs(rise(false)));
}

// Between a cold and a hot wall the temperature becomes a straight line.
TEST(Walls, HeatCrossesBetweenWallsOfGivenTemperature) {
  constexpr int n = 16;
  Particles<2> p = make_layer<2>(n, 0.5);
  p.temperature.assign(p.size(), 300.0);
  Material m = make_fluid();
  m.heat = HeatProperties{1.0, 200.0, 500.0};
  Obstacle<2> cold = make_plane<2>(0.0), hot = make_plane<2>(n * spacing);
  cold.temperature = 300.0;
  hot.temperature = 400.0;
  Colliders<2> colliders;
  colliders.add(std::move(cold));
  colliders.add(std::move(hot));
  Solver<2, double> solver(make_parameters<2>(), {m}, std::move(colliders), std::move(p));
  solver.prepare();
  constexpr double end = 0.6;  // the slowest mode falls to exp(-9) of its start
  for (double t = 0.0; t < end;) t += solver.step(end - t, t).dt;
  for (std::size_t i = 0; i < solver.particles().size(); ++i) {
    const double expected = 300.0 + 100.0 * solver.particles().position[i][1] / (n * spacing);
    EXPECT_NEAR(solver.particles().temperature[i], expected, 1.0) << "one percent of the difference";
  }
}

// A piston at five metres a second sweeps the fluid before it and leaves none behind.
TEST(Walls, APistonDrivesTheFluid) {
  Particles<2> p = make_layer<2>(6, 0.5);
  Obstacle<2> piston = make_plane<2>(0.0);
  piston.motion.velocity = Vec<2>(0.0, 5.0);
  auto parameters = make_parameters<2>();
  parameters.sound_speed = 50.0;
  parameters.artificial_viscosity = 0.5;
  Solver<2, double> solver(parameters, {make_fluid()}, one(std::move(piston)), std::move(p));
  solver.prepare();
  constexpr double end = 0.1;
  for (double t = 0.0; t < end;) t += solver.step(end - t, t).dt;
  double momentum = 0.0;
  for (std::size_t i = 0; i < solver.particles().size(); ++i) {
    EXPECT_GT(solver.particles().position[i][1], 5.0 * end);
    momentum += solver.particles().velocity[i][1];
  }
  EXPECT_GE(momentum / static_cast<double>(solver.particles().size()), 5.0);
}

/// What a particle at `x` sees of an obstacle, with h = 1.
WallNeighbour<3> look(const Colliders<3>& colliders, const Vec3& x, Walls<3>& walls) {
  const std::vector<Vec3> position{x};
  walls.reset(1);
  walls.update(colliders, position, std::vector<Vec3>{Vec3::Zero()}, 0.0);
  return *walls.of(0);
}

// Facets far smaller than h are taken by one point each: the same plane to a few thousandths.
TEST(Walls, AFineMeshIsTheSameWall) {
  Obstacle<3> coarse = make_plane<3>(0.0), fine;
  constexpr double edge = 0.15, reach = 3.0;
  const int n = static_cast<int>(2.0 * reach / edge);
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      const auto corner = [&](int a, int b) { return Vec3(-reach + (i + a) * edge, 0.0, -reach + (k + b) * edge); };
      fine.facets.push_back({corner(0, 0), corner(0, 1), corner(1, 1)});
      fine.facets.push_back({corner(0, 0), corner(1, 1), corner(1, 0)});
    }
  fine.wall = true;
  const Colliders<3> a = one(std::move(coarse)), b = one(std::move(fine));
  for (const double height : {0.3, 0.45, 0.9, 1.6}) {
    Walls<3> of_coarse(WallKernel<3>(1.0), 0.8, 0.2), of_fine(WallKernel<3>(1.0), 0.8, 0.2);
    const WallNeighbour<3> expected = look(a, Vec3(0.02, height, 0.05), of_coarse),
                           found = look(b, Vec3(0.02, height, 0.05), of_fine);
    ASSERT_EQ(expected.contacts.size(), 1u);
    ASSERT_EQ(found.contacts.size(), 1u);
    EXPECT_NEAR(found.contacts[0].distance, height, 1e-6) << "samples are in single precision";
    EXPECT_NEAR(found.contacts[0].area / expected.contacts[0].area, 1.0, 5e-3) << height;
    EXPECT_NEAR(found.solid, expected.solid, 2e-3 * 0.5) << height;
    EXPECT_NEAR((found.moment - expected.moment).norm(), 0.0, 3e-3) << height;
  }
}

/// Gentle hills, at any fineness.
Obstacle<3> make_hills(int n, double reach) {
  Obstacle<3> hills;
  hills.wall = true;
  const auto at = [&](int i, int k) {
    const double x = reach * (2.0 * i / n - 1.0), z = reach * (2.0 * k / n - 1.0);
    return Vec3(x, 0.1 * std::sin(1.1 * x) * std::cos(0.9 * z), z);
  };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      hills.facets.push_back({at(i, k), at(i, k + 1), at(i + 1, k + 1)});
      hills.facets.push_back({at(i, k), at(i + 1, k + 1), at(i + 1, k)});
    }
  return hills;
}

// From facets of two h to a twentieth of h: what a particle sees where it was found, and after it has moved by a
// quarter of h, is the sum over facets.
TEST(Walls, HillsOfAnyFinenessAreWhatTheirFacetsSumUpTo) {
  for (const int n : {4, 12, 40, 160}) {
    const Obstacle<3> hills = make_hills(n, 4.0);
    const std::vector<Simplex<3>> facets = hills.facets;
    const Colliders<3> colliders = one(hills);
    Walls<3> walls(WallKernel<3>(1.0), 0.8, 0.2);
    for (const double height : {0.5, 0.8, 1.5}) {
      const std::vector<Vec3> found{Vec3(0.3, height, -0.4)};
      walls.reset(1);
      // The second so little that the sums of the first are carried on.
      for (const Vec3& moved :
           {Vec3(0, 0, 0), Vec3(0.01, -0.015, 0.005), Vec3(0.1, -0.15, 0.1), Vec3(-0.1, 0.2, 0.05)}) {
        const std::vector<Vec3> now{found[0] + moved};
        walls.update(colliders, now, std::vector<Vec3>{Vec3::Zero()}, 0.0);
        double solid = 0.0;
        Vec3 push = Vec3::Zero(), expected = Vec3::Zero();
        Mat3 moment = Mat3::Zero();
        for (const auto& facet : facets) {
          const Vec3 normal = facet_normal<3>(facet);
          const FacetIntegrals<3> exact = integrate_facet<3>(WallKernel<3>(1.0), facet, normal, now[0]);
          expected += exact.area * normal;
          solid += exact.solid;
          moment += exact.solid * Mat3::Identity() - exact.first * normal.transpose();
        }
        for (const WallContact<3>& contact : walls.of(0)->contacts) push += contact.area * contact.normal;
        const std::string which = fmt::format("{} x {} cells, {} high, moved {}", n, n, height, moved.norm());
        EXPECT_LT((push - expected).norm(), 3e-3 * 0.7) << which;  // 0.7: on the wall
        EXPECT_LT(std::abs(walls.of(0)->solid - solid), 3e-3 * 0.5) << which;
        EXPECT_LT((walls.of(0)->moment - 0.5 * (moment + moment.transpose())).norm(), 4e-3) << which;
        if (n == 160) {
          EXPECT_LT(walls.of(0)->contacts.size(), 10u) << which;
        }
      }
    }
  }
}

/// Of radius 5, seen from outside.
std::vector<Simplex<3>> make_ball() {
  std::vector<Simplex<3>> ball;
  constexpr int n = 48;
  const auto on_ball = [](int i, int k) {
    const double polar = std::numbers::pi * i / n, azimuth = 2.0 * std::numbers::pi * k / n;
    return Vec3(5.0 * std::sin(polar) * std::cos(azimuth), 5.0 * std::cos(polar),
                5.0 * std::sin(polar) * std::sin(azimuth));
  };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      if (i > 0) ball.push_back({on_ball(i, k), on_ball(i, k + 1), on_ball(i + 1, k)});
      if (i < n - 1) ball.push_back({on_ball(i, k + 1), on_ball(i + 1, k + 1), on_ball(i + 1, k)});
    }
  return ball;
}

// A ball of many facets is a few patches, not a plane for each.
TEST(Walls, ACurvedMeshIsAFewPatches) {
  Obstacle<3> ball;
  ball.facets = make_ball();
  ball.wall = ball.closed = true;
  const std::vector<Simplex<3>> facets = ball.facets;
  const Colliders<3> colliders = one(std::move(ball));
  const Vec3 x(3.5, 4.1, 0.3);  // some 0.4 above it
  Walls<3> walls(WallKernel<3>(1.0), 0.8, 0.2);
  const WallNeighbour<3> seen = look(colliders, x, walls);
  EXPECT_LT(seen.contacts.size(), 25u);
  Vec3 push = Vec3::Zero(), expected = Vec3::Zero();
  double solid = 0.0;
  for (const auto& facet : facets) {
    const Vec3 normal = facet_normal<3>(facet);
    const FacetIntegrals<3> exact = integrate_facet<3>(WallKernel<3>(1.0), facet, normal, x);
    expected += exact.area * normal;
    solid += exact.solid;
  }
  for (const WallContact<3>& contact : seen.contacts) push += contact.area * contact.normal;
  EXPECT_NEAR((push - expected).norm() / expected.norm(), 0.0, 5e-3);
  EXPECT_NEAR(seen.solid, solid, 2e-3);
}

// What slides round in a bowl is pushed neither on nor back: over a way of many facets the push along it cancels. Sums
// that lag behind the particle by up to h/50 would push it on by 2e-3 of what holds it off, at any speed, and a pool
// would begin to turn.
TEST(Walls, SlidingRoundABowlIsPushedNeitherWay) {
  Obstacle<3> bowl;
  bowl.wall = true;
  bowl.facets = make_ball();
  const Colliders<3> colliders = one(std::move(bowl));
  constexpr double radius = 4.6, way = 0.0023, dt = 1e-3;
  const int n_steps = static_cast<int>(std::numbers::pi * radius / way);
  for (const double direction : {1.0, -1.0}) {
    Walls<3> walls(WallKernel<3>(1.0), 0.8, 0.2);
    walls.reset(1);
    double along = 0.0, across = 0.0;
    for (int k = 0; k < n_steps; ++k) {
      const double azimuth = direction * k * way / radius;
      const Vec3 out(std::cos(azimuth), 0.0, std::sin(azimuth)), on = direction * Vec3(-out[2], 0.0, out[0]);
      walls.update(colliders, std::vector<Vec3>{radius * out}, std::vector<Vec3>{way / dt * on}, k == 0 ? 0.0 : dt);
      Vec3 push = Vec3::Zero();
      for (const WallContact<3>& contact : walls.of(0)->contacts) push += contact.push * contact.normal;
      along += push.dot(on);
      across -= push.dot(out);
    }
    EXPECT_LT(std::abs(along / across), 1e-4) << direction;
  }
}

TEST(Walls, ResumeFromStateAloneIsExact) {
  const auto start = [] {
    Particles<2> p = make_layer<2>(6, 0.5);
    for (std::size_t i = 0; i < p.size(); ++i) p.velocity[i] = Vec<2>(0.2 * std::sin(40.0 * p.position[i][1]), 0.0);
    return p;
  };
  auto parameters = make_parameters<2>();
  parameters.gravity = Vec<2>(1.0, -9.81);
  parameters.density_diffusion = 0.1;
  parameters.hourglass_control = 1.0;
  Obstacle<2> plane = make_plane<2>(-0.1 * spacing);
  plane.motion.velocity = Vec<2>(0.0, 0.1);
  const auto frame = [](Solver<2, double>& solver, double from) {
    solver.prepare(from);
    for (double t = 0.0; t < 0.01;) t += solver.step(0.01 - t, from + t).dt;
  };
  Solver<2, double> whole(parameters, {make_fluid()}, one(plane), start());
  frame(whole, 0.0);
  Solver<2, double> resumed(parameters, {make_fluid()}, one(plane), whole.particles());
  frame(whole, 0.01);
  frame(resumed, 0.01);
  ASSERT_EQ(whole.particles().position, resumed.particles().position);
  ASSERT_EQ(whole.particles().density, resumed.particles().density);
}

}  // namespace
}  // namespace smelt
