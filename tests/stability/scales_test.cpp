// Slow, small and large: what single precision and absolute constants would spoil.

#include "bench/cases/set_up.h"
#include "tests/stability/watch.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace smelt {
namespace {

constexpr double density = 1000.0;

std::vector<Vec3> positions_by_id(const Particles<3>& p) {
  std::vector<Vec3> positions(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) positions[static_cast<std::size_t>(p.id[i])] = p.position[i];
  return positions;
}

// A step moves the blob by 3e-10 of its distance from the origin: single precision positions would not see it move at
// all.
TEST(Scales, CreepOfAMicrometreASecond) {
  constexpr double spacing = 0.05, speed = 1e-6;
  constexpr int steps = 100000;
  const Vec3 far(10.0, 3.0, -7.0);
  Particles<3> p =
      make_block<3>({far - Vec3::Constant(1.5 * spacing), far + Vec3::Constant(1.5 * spacing)}, spacing, density, 0.1);
  for (auto& v : p.velocity) v = Vec3(speed, 0.0, 0.0);
  const std::vector<Vec3> start = p.position;
  auto parameters = make_parameters<3>(spacing, 5.0);
  parameters.shear_wave_speed = 5.0;
  parameters.artificial_viscosity = 0.3;
  parameters.xsph = 0.3;
  Solver<3, float> solver(parameters, {viscoplastic_material(density, 100.0, 50.0, 0.5, 1000.0)}, {}, std::move(p));
  solver.prepare();
  double time = 0.0;
  for (int n = 0; n < steps; ++n) time += solver.step(1.0, time).dt;

  const std::vector<Vec3> end = positions_by_id(solver.particles());
  double largest = 0.0;
  for (std::size_t i = 0; i < end.size(); ++i)
    largest = std::max(largest, (end[i] - start[i] - Vec3(speed * time, 0.0, 0.0)).norm() / (speed * time));
  report_row({.problem = "creep of 1e-6 m/s; pair loops in float",
              .quantity = "displacement of any particle / speed time",
              .resolution = fmt::format("{} particles {} steps", end.size(), steps),
              .error = largest,
              .bar = 0.01});
}

/// A block 10 particles high that spins, stretches and falls, `size` metres high, all dimensionless numbers alike:
/// lengths go as size, times and speeds as its root, viscosities as size^1.5 and stresses as size, with density and
/// gravity fixed. Positions over size after `steps` steps.
std::vector<Vec3> fall_at_scale(double size, int steps) {
  const double spacing = 0.1 * size, speed = std::sqrt(size);
  Particles<3> p = make_block<3>({Vec3(-0.3, -0.5, -0.3) * size, Vec3(0.3, 0.5, 0.3) * size}, spacing, density, 0.1);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 x = p.position[i] / size;
    p.velocity[i] = speed * Vec3(2.0 * x[0] - 3.0 * x[1], 3.0 * x[0] - 2.0 * x[1], 0.3 * x[1]);
  }
  auto parameters = make_parameters<3>(spacing, 20.0 * speed);
  parameters.gravity = Vec3(0.0, -9.81, 0.0);
  parameters.shear_wave_speed = 20.0 * speed;
  parameters.artificial_viscosity = 0.3;
  parameters.xsph = 0.3;
  Material m = viscoplastic_material(density, 500.0 * size, 1.0, 0.5, 0.0);
  // K gdot^n is a stress and gdot goes as 1/time, so K goes as size^(1 + n/2).
  m.rheology.consistency = {200.0 * std::pow(size, 1.25), 200.0 * std::pow(size, 1.25)};
  m.rheology.jump_number.reset();
  const double rest_viscosity = 5e3 * std::pow(size, 1.5);
  m.rheology.rest_viscosity = ThermalRange{rest_viscosity, rest_viscosity};
  Solver<3, float> solver(parameters, {m}, {}, std::move(p));
  solver.prepare();
  double time = 0.0;
  for (int n = 0; n < steps; ++n) time += solver.step(1e9, time).dt;
  std::vector<Vec3> positions = positions_by_id(solver.particles());
  for (auto& x : positions) x /= size;
  return positions;
}

TEST(Scales, OneMillimetreAndOneKilometre) {
  constexpr int steps = 400;
  const std::vector<Vec3> middle = fall_at_scale(1.0, steps);
  for (const double size : {1e-3, 1e3}) {
    const std::vector<Vec3> scaled = fall_at_scale(size, steps);
    double largest = 0.0;
    for (std::size_t i = 0; i < middle.size(); ++i) largest = std::max(largest, (scaled[i] - middle[i]).norm());
    report_row({.problem = fmt::format("a scene {} m high against the same at 1 m", size),
                .quantity = "distance of any particle / height",
                .resolution = fmt::format("{} particles {} steps", middle.size(), steps),
                .error = largest,
                .bar = 1e-6});
  }
}

}  // namespace
}  // namespace smelt
