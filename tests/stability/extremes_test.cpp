// Scenes at the edge of what the method can be asked: each must end, finite and with no energy from nowhere.

#include "bench/cases/set_up.h"
#include "core/sph/rheology.h"
#include "tests/stability/watch.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace smelt {
namespace {

constexpr double density = 1000.0, spacing = 0.05;
constexpr double energy_bar = 0.01;

/// All terms on, free of walls.
SolverParameters<3> all_terms() {
  auto parameters = make_parameters<3>(spacing, 20.0);
  parameters.gravity = Vec3(0.0, -9.81, 0.0);
  parameters.shear_wave_speed = 20.0;
  parameters.artificial_viscosity = 0.3;
  parameters.xsph = 0.3;
  parameters.hourglass_control = 1.0;
  return parameters;
}

Material soft_material() {
  return viscoplastic_material(density, 100.0, 50.0, 0.5, 1000.0);
}

/// Spins and stretches: v = (4 x - 6 y, 6 x - 4 y, 0) in 1/s, far beyond what the yield stress of soft_material holds.
void set_in_motion(Particles<3>& p) {
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3& x = p.position[i];
    p.velocity[i] = Vec3(4.0 * x[0] - 6.0 * x[1], 6.0 * x[0] - 4.0 * x[1], 0.0);
  }
}

Particles<3> moving_block(int edge) {
  const Vec3 half = Vec3::Constant(0.5 * edge * spacing);
  Particles<3> p = make_block<3>({-half, half}, spacing, density, 0.1);
  set_in_motion(p);
  return p;
}

TEST(Extremes, TwoParticlesOnOnePlace) {
  Particles<3> pair;
  add_particle<3>(pair, Vec3(0.0, 0.0, 0.0), Vec3(0.5, 0.1, 0.0), density);
  add_particle<3>(pair, Vec3(1e-9, 0.0, 0.0), Vec3(-0.5, 0.0, 0.0), density);
  Solver<3, float> lone(all_terms(), {soft_material()}, {}, std::move(pair));
  report_watched("two particles 1e-9 m apart that meet at 1 m/s", watch(lone, 0.3), 2, energy_bar);

  Particles<3> block = moving_block(6);
  const Vec3 middle = block.position[100];
  add_particle<3>(block, middle + Vec3(1e-9, 0.0, 0.0), block.velocity[100] + Vec3(-1.0, 0.0, 0.0), density);
  Solver<3, float> within(all_terms(), {soft_material()}, {}, std::move(block));
  report_watched("two particles 1e-9 m apart within a block", watch(within, 0.3), within.particles().size(),
                 energy_bar);
}

TEST(Extremes, ViscosityJumpsAMillionfold) {
  for (const bool relaxed : {true, false}) {
    Particles<3> p = moving_block(6);
    for (const Vec3& x : p.position) p.material.push_back(x[0] < 0.0 ? 0 : 1);
    auto parameters = all_terms();
    if (!relaxed) parameters.shear_wave_speed = 0.0;
    // The stress without memory limits the step to a sixtieth of what sound allows: a shorter run.
    const double duration = relaxed ? 0.3 : 0.1;
    constexpr double thin = 1e-2;
    Solver<3, float> solver(parameters, {newtonian_material(density, thin), newtonian_material(density, 1e6 * thin)},
                            {}, std::move(p));
    const Watched seen = watch(solver, duration);
    report_watched(relaxed ? "viscosity jumps 10^6-fold; relaxed stress" : "viscosity jumps 10^6-fold; stress at once",
                   seen, solver.particles().size(), energy_bar);
  }
}

TEST(Extremes, JumpNumberFromOneTo1e5) {
  Watched worst;
  std::size_t n = 0;
  for (const double jump : {1.0, 10.0, 1e2, 1e3, 1e4, 1e5}) {
    SCOPED_TRACE(jump);
    Solver<3, float> solver(all_terms(), {viscoplastic_material(density, 100.0, 50.0, 0.5, jump)}, {}, moving_block(6));
    const Watched seen = watch(solver, 0.3);
    EXPECT_LE(seen.energy_gain, energy_bar);
    worst = {std::max(worst.energy_gain, seen.energy_gain), std::max(worst.density_error, seen.density_error),
             std::max(worst.steps, seen.steps)};
    n = solver.particles().size();
  }
  report_watched("blocks with J from 1 to 10^5; the worst", worst, n, energy_bar);
}

TEST(Extremes, ThreadOneParticleThick) {
  Particles<3> p;
  for (int i = 0; i < 40; ++i) {
    const double phase = 2.0 * std::numbers::pi * i / 20.0;
    add_particle<3>(p, Vec3(i * spacing, 0.0, 0.0), Vec3(0.3 * std::cos(phase), std::sin(phase), 0.5 * std::cos(phase)),
                    density);
  }
  Solver<3, float> solver(all_terms(), {soft_material()}, {}, std::move(p));
  report_watched("thread one particle thick", watch(solver, 0.5), 40, energy_bar);
}

TEST(Extremes, DropsOfOneTwoAndFive) {
  for (const int n : {1, 2, 5}) {
    Particles<3> p;
    const Vec3 corners[5] = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 1, 0)};
    for (int i = 0; i < n; ++i) add_particle<3>(p, spacing * corners[i], Vec3(0.1, 1.0, 0.0), density);
    for (std::size_t i = 0; i < p.size(); ++i)
      p.velocity[i] += Vec3(0.0, 0.0, 3.0).cross(p.position[i]) - 1.5 * p.position[i];
    Solver<3, float> solver(all_terms(), {soft_material()}, {}, std::move(p));
    report_watched(fmt::format("drop of {}", n), watch(solver, 0.5), static_cast<std::size_t>(n), energy_bar);
  }
}

TEST(Extremes, HotBesideCold) {
  Particles<3> p = moving_block(6);
  for (const Vec3& x : p.position) p.temperature.push_back(x[0] < 0.0 ? 1.0 : 5000.0);
  Material m = soft_material();
  m.rheology.jump_number = ThermalRange{1e5, 1.0};
  m.heat = HeatProperties{10.0, 300.0, 400.0};  // conduction, not sound, limits the step
  Solver<3, float> solver(all_terms(), {m}, {}, std::move(p));
  const Watched seen = watch(solver, 0.1);
  report_watched("1 K beside 5000 K", seen, solver.particles().size(), energy_bar);
  const auto [coldest, hottest] =
      std::minmax_element(solver.particles().temperature.begin(), solver.particles().temperature.end());
  EXPECT_GT(*coldest, 10.0) << "heat did not flow";
  report_row({.problem = "1 K beside 5000 K",
              .quantity = "temperature beyond its bounds [K]",
              .resolution = fmt::format("{} particles {} steps", solver.particles().size(), seen.steps),
              .error = std::max({0.0, 1.0 - *coldest, *hottest - 5000.0}),
              .bar = 0.0});
}

}  // namespace
}  // namespace smelt
