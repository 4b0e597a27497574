// The areas that particles stand for at a free surface, against the surface's own.

#include "core/sph/free_surface.h"

#include "bench/cases/set_up.h"
#include "core/sph/solver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

namespace smelt {
namespace {

constexpr double dx = 0.01, density = 1000.0;

/// What a solver of these particles finds.
template <int Dim>
Solver<Dim, double> make_solver(Particles<Dim> particles, const Box<Dim>& period = {}, Colliders<Dim> colliders = {}) {
  auto parameters = make_parameters<Dim>(dx, 1.0);
  parameters.period = period;
  parameters.ambient = Ambient{300.0, 1.0};
  Material m = inviscid_material(density);
  m.heat = HeatProperties{1e-6, 300.0, 400.0};
  m.heat->specific_heat = 1000.0;
  particles.temperature.assign(particles.size(), 350.0);
  Solver<Dim, double> solver(parameters, {m}, std::move(colliders), std::move(particles));
  solver.prepare();
  return solver;
}

template <int Dim>
double total_area(const Solver<Dim, double>& solver) {
  return std::accumulate(solver.free_surface_area().begin(), solver.free_surface_area().end(), 0.0);
}

template <int Dim>
Box<Dim> box_of(const Vec<Dim>& lower, const Vec<Dim>& upper) {
  Box<Dim> box;
  box.lower = lower;
  box.upper = upper;
  return box;
}

/// Repeats along all axes but the last.
template <int Dim>
Box<Dim> sideways(const Box<Dim>& box) {
  Box<Dim> period = box;
  period.lower[Dim - 1] = 0.0;
  period.upper[Dim - 1] = -1.0;
  return period;
}

template <int Dim>
void expect_slab(double jitter, double tolerance) {
  const Box<Dim> box = box_of<Dim>(Vec<Dim>::Zero(), Vec<Dim>::Constant(10.0 * dx));
  const auto solver = make_solver<Dim>(make_block<Dim>(box, dx, density, jitter), sideways<Dim>(box));
  const double face = std::pow(10.0 * dx, Dim - 1);
  EXPECT_NEAR(total_area(solver) / (2.0 * face), 1.0, tolerance) << Dim << "D, jitter " << jitter;
  for (std::size_t i = 0; i < solver.particles().size(); ++i) {
    const double z = solver.particles().position[i][Dim - 1] / dx;
    if (z > 2.5 && z < 7.5) {
      EXPECT_LT(solver.free_surface_area()[i], 0.05 * std::pow(dx, Dim - 1)) << "inside";
    }
  }
}

TEST(FreeSurface, SlabHasItsTwoFaces) {
  expect_slab<3>(0.0, 0.002);
  expect_slab<3>(0.1, 0.01);
  expect_slab<3>(0.2, 0.03);
  expect_slab<2>(0.0, 0.002);
  expect_slab<2>(0.1, 0.02);
  expect_slab<2>(0.2, 0.05);
}

TEST(FreeSurface, LineHasTwoEnds) {
  const auto solver = make_solver<1>(make_block<1>(box_of<1>(Vec<1>(0.0), Vec<1>(20.0 * dx)), dx, density));
  EXPECT_NEAR(total_area(solver), 2.0, 1e-9);
}

/// Against the ball of the same volume.
TEST(FreeSurface, BallsAreBalls) {
  constexpr double pi = std::numbers::pi;
  for (const double jitter : {0.0, 0.1, 0.2}) {
    for (const auto& [radius, tolerance] : {std::pair{3.0, 0.07}, std::pair{5.0, 0.04}, std::pair{8.0, 0.025}}) {
      const auto solver = make_solver<3>(make_ball<3>(radius * dx, dx, density, jitter));
      const double volume = static_cast<double>(solver.particles().size()) * dx * dx * dx;
      const double area = 4.0 * pi * std::pow(0.75 * volume / pi, 2.0 / 3.0);
      EXPECT_NEAR(total_area(solver) / area, 1.0, tolerance) << "radius " << radius << " jitter " << jitter;
    }
    const auto disc = make_solver<2>(make_ball<2>(10.0 * dx, dx, density, jitter));
    const double volume = static_cast<double>(disc.particles().size()) * dx * dx;
    EXPECT_NEAR(total_area(disc) / (2.0 * std::sqrt(pi * volume)), 1.0, 0.05) << "disc, jitter " << jitter;
  }
}

// What docs/decisions/0011 says of what is thinner than the kernel.
TEST(FreeSurface, ThinThingsHaveSome) {
  const Box<3> box = box_of<3>(Vec3::Zero(), Vec3(0.1, 0.1, 0.01));
  EXPECT_NEAR(total_area(make_solver<3>(make_block<3>(box, dx, density), sideways<3>(box))) / (0.1 * 0.1), 1.0, 0.01)
      << "once, not twice";
  Particles<3> lone;
  add_particle<3>(lone, Vec3::Zero(), Vec3::Zero(), density);
  const double ball = std::numbers::pi * std::pow(6.0 / std::numbers::pi, 2.0 / 3.0) * dx * dx;
  const double area = total_area(make_solver<3>(std::move(lone)));
  EXPECT_GT(area, 0.6 * ball);
  EXPECT_LT(area, ball);
}

/// A tank of walls: floor and two sides, solid below and beyond.
Colliders<2> make_tank(double width) {
  Obstacle<2> tank;
  tank.wall = true;
  tank.closed = true;
  const std::vector<Vec<2>> corners = {Vec<2>(0.0, 1.0), Vec<2>(0.0, 0.0), Vec<2>(width, 0.0), Vec<2>(width, 1.0)};
  for (std::size_t i = 1; i < corners.size(); ++i) tank.facets.push_back({corners[i], corners[i - 1]});
  Colliders<2> colliders;
  colliders.add(std::move(tank));
  return colliders;
}

TEST(FreeSurface, WallsAreNone) {
  for (const double jitter : {0.0, 0.1}) {
    const auto block = make_block<2>(box_of<2>(Vec<2>::Zero(), Vec<2>(0.2, 0.1)), dx, density, jitter);
    const auto solver = make_solver<2>(block, {}, make_tank(0.2));
    EXPECT_NEAR(total_area(solver) / 0.2, 1.0, 0.03) << "jitter " << jitter;
    for (std::size_t i = 0; i < solver.particles().size(); ++i)
      if (solver.particles().position[i][1] < 7.5 * dx) {
        EXPECT_LT(solver.free_surface_area()[i], 0.05 * dx);
      }
  }
  // A film one particle thick on the floor of a wide space.
  Particles<2> film = make_block<2>(box_of<2>(Vec<2>(0.5, 0.0), Vec<2>(0.7, dx)), dx, density);
  EXPECT_NEAR(total_area(make_solver<2>(std::move(film), {}, make_tank(2.0))) / 0.2, 1.0, 0.12) << "with its two ends";
}

}  // namespace
}  // namespace smelt
