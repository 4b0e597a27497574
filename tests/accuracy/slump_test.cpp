// The slump of a Bingham cylinder under its own weight, 3D, against the formula of Pashias et al. (1996).

#include "tests/accuracy/measure.h"
#include "tests/accuracy/set_up.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace smelt {
namespace {

constexpr double height = 0.3, gravity = 9.81, density = 1000.0;

/// A sheet of two triangles at y = 0 that no particle gets past the edge of; no slip.
Colliders<3> make_floor() {
  Obstacle<3> floor;
  floor.facets = {{Vec3(-9, 0, -9), Vec3(-9, 0, 9), Vec3(9, 0, 9)}, {Vec3(-9, 0, -9), Vec3(9, 0, 9), Vec3(9, 0, -9)}};
  floor.wall = true;
  Colliders<3> colliders;
  colliders.add(std::move(floor));
  return colliders;
}

/// (H - h)/H of a cylinder as wide as tall, `n` particles high, whose yield stress is `relative_yield` rho g H, after three seconds. The
/// formula is a balance at rest, so the consistency is high enough for inertia not to carry the column past it: 60 Pa s, with which
/// the wide slump takes half a second.
double simulate_slump(double relative_yield, int n) {
  const double spacing = height / n, sound_speed = 10.0 * std::sqrt(2.0 * gravity * height);
  Box<3> box;
  box.lower = Vec3(-0.5 * height, 0.0, -0.5 * height);
  box.upper = Vec3(0.5 * height, height, 0.5 * height);
  Particles<3> particles = make_lattice<3>(box, spacing, density, 0.0, [](const Vec3& x) { return std::hypot(x[0], x[2]) <= 0.5 * height; });
  auto parameters = make_parameters<3>(spacing, sound_speed);
  parameters.gravity = Vec3(0.0, -gravity, 0.0);
  parameters.shear_wave_speed = sound_speed;
  parameters.artificial_viscosity = 0.2;
  parameters.hourglass_control = 1.0;
  parameters.courant = 0.4;
  const Material clay = viscoplastic_material(density, relative_yield * density * gravity * height, 60.0, 1.0, 1e4);
  Solver<3, float> solver(parameters, {clay}, make_floor(), std::move(particles));
  solver.prepare();
  advance_by(solver, 3.0);
  double top = 0.0;
  for (const Vec3& x : solver.particles().position) top = std::max(top, x[1] + 0.5 * spacing);
  return 1.0 - top / height;
}

class Slump : public testing::TestWithParam<double> {};

TEST_P(Slump, BinghamCylinder) {
  constexpr int n = 16;
  const double expected = read_reference("bingham_slump_cylinder").at(GetParam());
  const double slump = simulate_slump(GetParam(), n);
  report_row({.problem = fmt::format("slump of a Bingham cylinder; yield stress / (rho g H) = {}", GetParam()),
              .quantity = fmt::format("slump / the formula's {:.3f} - 1", expected),
              .resolution = fmt::format("{} particles high", n),
              .error = std::abs(slump / expected - 1.0),
              .bar = 0.1});
}
INSTANTIATE_TEST_SUITE_P(YieldStress, Slump, testing::Values(0.1, 0.2, 0.3));

}  // namespace
}  // namespace smelt
