#include "core/sph/heat_exchange.h"

#include "bench/cases/set_up.h"
#include "core/error.h"
#include "core/sph/enthalpy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace smelt {
namespace {

HeatProperties wax() {
  HeatProperties heat{1e-6, 330.0, 330.0};
  heat.specific_heat = 2000.0;
  heat.latent_heat = 2e5;
  heat.emissivity = 0.9;
  return heat;
}

/// Solves with the wax's T(H).
double exchanged(const SurfaceExchange& exchange, double resistance, double share, double target) {
  const HeatProperties heat = wax();
  return exchange_enthalpy(
      exchange, resistance, share, target, [&](double h) { return temperature_at_enthalpy(heat, h); },
      [&](double h) { return temperature_slope(heat, h); });
}

TEST(HeatExchange, BackwardEulerHoldsForAnyStepAndOnThePlateau) {
  const SurfaceExchange exchange{
      .convection = 20.0, .emissivity = 0.9, .ambient = 290.0, .source_conductance = 3.0, .source_input = 900.0};
  for (const double target : {-5e4, 10.0, 1e5, 1.99999e5, 4e5, 2e6})
    for (const double share : {1e-9, 1e-3, 1.0, 1e6})
      for (const double resistance : {0.0, 0.01, 10.0}) {
        const double h = exchanged(exchange, resistance, share, target);
        const double t = temperature_at_enthalpy(wax(), h);
        const double t_s = surface_temperature(exchange, resistance, t);
        EXPECT_NEAR(t_s + resistance * exchange.loss(t_s), t, 1e-10 * t);
        EXPECT_NEAR(h + share * exchange.loss(t_s), target, 1e-9 * (std::abs(target) + std::abs(h)));
        // Never past the balance with the surroundings, at 291.07 K.
        if (target > 0.0) {
          EXPECT_GT(t, 291.0);
        }
      }
}

TEST(HeatExchange, ManySmallStepsAndFewLargeOnesReachTheSameBalance) {
  const SurfaceExchange exchange{.convection = 20.0, .emissivity = 0.9, .ambient = 290.0};
  double small = 3e5, large = 3e5;
  for (int n = 0; n < 4000; ++n) small = exchanged(exchange, 0.0, 1.0, small);
  for (int n = 0; n < 8; ++n) large = exchanged(exchange, 0.0, 1e6, large);
  EXPECT_NEAR(temperature_at_enthalpy(wax(), small), 290.0, 1e-6);
  EXPECT_NEAR(temperature_at_enthalpy(wax(), large), 290.0, 1e-6);
}

Material warm_material() {
  Material m = inviscid_material(900.0);
  m.heat = wax();
  return m;
}

/// A block of 3D particles with heat; nothing moves.
SolverParameters<3> still_parameters() {
  auto parameters = make_parameters<3>(0.01, 1.0);
  parameters.ambient = Ambient{290.0, 25.0};
  return parameters;
}

Particles<3> warm_block(double temperature) {
  Particles<3> p = make_block<3>({Vec3::Zero(), Vec3::Constant(0.08)}, 0.01, 900.0, 0.1);
  p.temperature.assign(p.size(), temperature);
  return p;
}

double total_enthalpy(const Solver<3, float>& solver) {
  double sum = 0.0;
  for (std::size_t i = 0; i < solver.particles().size(); ++i) sum += solver.mass(i) * solver.enthalpy(i);
  return sum;
}

/// Advances by n steps of dt; returns what passed.
HeatLedger run(Solver<3, float>& solver, int n, double dt) {
  for (int k = 0; k < n; ++k) EXPECT_EQ(solver.step(dt, k * dt).dt, dt);
  return solver.heat_ledger();
}

TEST(HeatExchange, LedgerAccountsForTheEnthalpy) {
  auto parameters = still_parameters();
  HeatSource<3> lamp;
  lamp.position = Vec3(0.0, 0.04, 0.04);
  lamp.radius = 0.03;
  lamp.power = 5.0;
  HeatSource<3> flame = lamp;
  flame.position = Vec3(0.08, 0.04, 0.04);
  flame.power.reset();
  flame.temperature = 900.0;
  flame.heat_transfer = 50.0;
  parameters.heat_sources = {lamp, flame};
  Solver<3, float> solver(parameters, {warm_material()}, {}, warm_block(335.0));
  solver.prepare();
  const double before = total_enthalpy(solver);
  const HeatLedger passed = run(solver, 200, 1e-3);
  EXPECT_GT(passed.radiated, 0.0);
  EXPECT_GT(passed.convected, 0.0);
  EXPECT_GT(passed.from_sources, 5.0 * 0.2);
  EXPECT_EQ(passed.to_walls, 0.0);
  const double lost = passed.radiated + passed.convected - passed.from_sources;
  EXPECT_NEAR(before - total_enthalpy(solver), lost, 1e-6 * passed.radiated);
  solver.prepare();
  EXPECT_EQ(solver.heat_ledger().radiated, 0.0) << "a frame's ledger starts anew";
}

TEST(HeatExchange, GivenPowerArrivesWholeAndOnlyWhileItBurns) {
  auto parameters = still_parameters();
  parameters.ambient.reset();
  HeatSource<3> lamp;
  lamp.position = Vec3(0.04, 0.09, 0.04);
  lamp.radius = 0.03;
  lamp.power = 7.0;
  lamp.begin = 0.0505;
  lamp.end = 0.1505;
  parameters.heat_sources = {lamp};
  Material m = warm_material();
  m.heat->emissivity = 0.0;
  Solver<3, float> solver(parameters, {m}, {}, warm_block(300.0));
  solver.prepare();
  const double before = total_enthalpy(solver);
  const HeatLedger passed = run(solver, 300, 1e-3);
  EXPECT_NEAR(passed.from_sources, 7.0 * 0.1, 1e-9);
  EXPECT_NEAR(total_enthalpy(solver) - before, 0.7, 1e-6);
  const auto& p = solver.particles();
  for (std::size_t i = 0; i < p.size(); ++i)
    if (p.position[i][1] < 0.04) {
      EXPECT_NEAR(p.temperature[i], 300.0, 1e-3) << "far from the lamp";
    }
}

// What a vent drives has a free surface too, in the lamp's light, and takes nothing up.
TEST(HeatExchange, GivenPowerArrivesWholeBesideAVent) {
  auto parameters = still_parameters();
  parameters.ambient.reset();
  Emitter<3> vent;
  vent.position = Vec3(0.04, 0.15, 0.04);
  vent.direction = Vec3(0, 1, 0);
  vent.radius = 0.02;
  vent.flow_rate = 1e-4;
  vent.end = 1.0;
  vent.temperature = 300.0;
  parameters.emitters = {vent};
  HeatSource<3> lamp;
  lamp.position = Vec3(0.04, 0.12, 0.04);
  lamp.radius = 0.06;
  lamp.power = 7.0;
  parameters.heat_sources = {lamp};
  Material m = warm_material();
  m.heat->emissivity = 0.0;
  Solver<3, float> solver(parameters, {m}, {}, warm_block(300.0));
  solver.prepare();
  const HeatLedger passed = run(solver, 300, 1e-3);
  EXPECT_GT(solver.particles().size(), 520u) << "it pours";
  EXPECT_NEAR(passed.from_sources, 7.0 * 0.3, 1e-9);
}

// Fluid at rest, and a lid that comes down on it: what it covers is no free surface any more.
TEST(HeatExchange, ALidThatComesDownCoversTheSurface) {
  Obstacle<3> lid;
  lid.wall = true;
  lid.temperature = 290.0;
  for (const auto& [a, b] :
       {std::pair(Vec3(-1, 0.12, -1), Vec3(1, 0.12, -1)), std::pair(Vec3(1, 0.12, 1), Vec3(-1, 0.12, 1))})
    lid.facets.push_back({a, b, Vec3(-a[0], 0.12, -a[2])});
  lid.motion.velocity = Vec3(0.0, -0.03, 0.0);
  Colliders<3> colliders;
  colliders.add(std::move(lid));
  Solver<3, float> solver(still_parameters(), {warm_material()}, std::move(colliders), warm_block(335.0));
  const auto area = [&] {
    return std::accumulate(solver.free_surface_area().begin(), solver.free_surface_area().end(), 0.0);
  };
  solver.prepare();
  const double open = area();
  run(solver, 1000, 1e-3);
  const double covered = area();
  EXPECT_LT(covered, 0.95 * open);
  solver.prepare(1.0);
  EXPECT_NEAR(covered, area(), 0.02 * open);
}

TEST(HeatExchange, HeatThroughWallsIsInTheLedger) {
  auto parameters = still_parameters();
  parameters.ambient = Ambient{290.0, 0.0};
  Material m = warm_material();
  m.heat->emissivity = 0.0;
  m.heat->diffusivity = 1e-4;
  Obstacle<3> floor;
  floor.wall = true;
  floor.temperature = 280.0;
  const auto corner = [](double x, double z) { return Vec3(x, 0.0, z); };
  floor.facets = {{corner(-1, -1), corner(-1, 1), corner(1, 1)}, {corner(-1, -1), corner(1, 1), corner(1, -1)}};
  Colliders<3> colliders;
  colliders.add(std::move(floor));
  Solver<3, float> solver(parameters, {m}, std::move(colliders), warm_block(340.0));
  solver.prepare();
  const double before = total_enthalpy(solver);
  const HeatLedger passed = run(solver, 100, 1e-3);
  EXPECT_GT(passed.to_walls, 0.0);
  EXPECT_NEAR(before - total_enthalpy(solver), passed.to_walls, 1e-6 * passed.to_walls);
}

// Latent heat without a range would divide by its width; energies without a specific heat mean nothing.
TEST(HeatExchange, RefusesWhatCannotBe) {
  const auto expect_refused = [](auto change, const char* why) {
    auto parameters = still_parameters();
    Material m = warm_material();
    change(parameters, m);
    try {
      Particles<3> p = make_block<3>({Vec3::Zero(), Vec3::Constant(0.02)}, 0.01, 900.0);
      if (m.heat) p.temperature.assign(p.size(), 300.0);
      Solver<3, float> solver(parameters, {m}, {}, std::move(p));
      ADD_FAILURE() << "not refused: " << why;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  expect_refused([](auto&, Material& m) { m.heat->specific_heat = 0.0; }, "need its specific heat");
  expect_refused([](auto&, Material& m) { m.heat->latent_heat = 0.0; }, "only with latent heat may they be equal");
  expect_refused([](auto&, Material& m) { m.heat->emissivity = 1.5; }, "from 0 to 1, is 1.5");
  expect_refused([](auto& p, Material&) { p.ambient.reset(); }, "no ambient temperature");
  expect_refused([](auto&, Material& m) { m.heat.reset(); }, "no material has heat");
}

}  // namespace
}  // namespace smelt
