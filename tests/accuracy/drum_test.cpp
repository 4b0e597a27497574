// Walls that turn: a drum carries what it holds to a rigid rotation; Couette flow between a cylinder that turns and one
// that does not.

#include "bench/cases/set_up.h"
#include "tests/accuracy/measure.h"
#include "tests/bodies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace smelt {
namespace {

constexpr double pi = std::numbers::pi, density = 1000.0, viscosity = 100.0, outer = 0.5, spin = 2.0;

/// Particles on rings between two radii, `spacing` [m] apart; the volume of each is its share of the whole.
Particles<2> make_rings(double from, double spacing, double& volume) {
  Particles<2> p;
  const int n_rings = static_cast<int>(std::lround((outer - from) / spacing));
  for (int k = 0; k < n_rings; ++k) {
    const double r = from + (k + 0.5) * (outer - from) / n_rings;
    const int n = static_cast<int>(std::lround(2.0 * pi * r / spacing));
    for (int i = 0; i < n; ++i) {
      const double angle = 2.0 * pi * (i + 0.37 * k) / n;
      p.id.push_back(static_cast<std::int32_t>(p.id.size()));
      p.position.push_back(r * Vec<2>(std::cos(angle), std::sin(angle)));
      p.velocity.push_back(Vec<2>::Zero());
      p.density.push_back(density);
    }
  }
  volume = pi * (outer * outer - from * from) / static_cast<double>(p.size());
  return p;
}

Obstacle<2> make_cylinder(double radius, bool around_fluid, double turns) {
  Obstacle<2> cylinder;
  // A polygon of the circle's area.
  constexpr int n = 96;
  cylinder.facets = make_polygon(n, radius * std::sqrt(2.0 * pi / n / std::sin(2.0 * pi / n)), Vec<2>::Zero());
  if (around_fluid)
    for (auto& facet : cylinder.facets) std::swap(facet[0], facet[1]);
  cylinder.wall = cylinder.closed = true;
  cylinder.motion.spin = to_skew(turns);
  return cylinder;
}

/// Runs fluid between the cylinders from rest for `duration` [s] and returns what |v - expected(r)| comes to over spin
/// R.
Norms measure_flow(double inner, double inner_spin, double outer_spin, double spacing, double duration,
                   const std::function<double(double)>& expected) {
  double volume = 0.0;
  Particles<2> fluid = make_rings(inner, spacing, volume);
  auto parameters = make_parameters<2>(spacing, 15.0 * spin * outer);
  parameters.particle_volume = volume;
  parameters.smoothing_length = 1.3 * spacing;
  parameters.artificial_viscosity = 0.0;
  parameters.density_diffusion = 0.1;
  parameters.hourglass_control = 1.0;
  Colliders<2> colliders;
  colliders.add(make_cylinder(outer, true, outer_spin));
  if (inner > 0.0) colliders.add(make_cylinder(inner, false, inner_spin));
  Solver<2, double> solver(parameters, {newtonian_material(density, viscosity)}, std::move(colliders),
                           std::move(fluid));
  solver.prepare();
  advance_by(solver, duration);
  std::vector<double> differences;
  for (std::size_t i = 0; i < solver.particles().size(); ++i) {
    const Vec<2>& x = solver.particles().position[i];
    const double r = x.norm();
    EXPECT_LT(r, outer) << "out of the drum";
    EXPECT_GT(r, inner * 0.99) << "in the cylinder";
    const Vec<2> round(-x[1] / r, x[0] / r);
    differences.push_back((solver.particles().velocity[i] - expected(r) * round).norm() / (spin * outer));
  }
  return compute_norms(differences);
}

TEST(TurningWalls, ADrumCarriesItsFluidToRigidRotation) {
  const std::string problem = "spin-up in a drum; no slip";
  for (const double across : {10.0, 20.0}) {
    const Norms error =
        measure_flow(0.0, 0.0, spin, outer / across, full_run() ? 10.0 : 4.0, [](double r) { return spin * r; });
    const std::string resolution = fmt::format("{:g} over the radius", across);
    report_row({problem, "velocity against omega r over omega R; l2", resolution, error.l2, 0.01});
    report_row({problem, "the same; max", resolution, error.max});
  }
}

TEST(TurningWalls, CouetteBetweenCylinders) {
  constexpr double inner = 0.25;
  const double b = spin * inner * inner / (1.0 - inner * inner / (outer * outer)), a = -b / (outer * outer);
  const std::string problem = "Couette flow between cylinders; the inner one turns";
  for (const double across : {10.0, 20.0}) {
    if (across > 10.0 && !full_run()) continue;
    const Norms error =
        measure_flow(inner, spin, 0.0, (outer - inner) / across, 2.0, [&](double r) { return a * r + b / r; });
    const std::string resolution = fmt::format("{:g} across the gap", across);
    report_row({problem, "velocity against a r + b/r over omega R_outer; l2", resolution, error.l2, 0.02});
    report_row({problem, "the same; max", resolution, error.max});
  }
}

}  // namespace
}  // namespace smelt
