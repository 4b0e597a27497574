// Lava that has set stays where it is, and later lava flows over and around it.

#include "bench/cases/tank.h"
#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace smelt {
namespace {

constexpr double spacing = 0.0125, density = 2500.0, solid_below = 1100.0, liquid_above = 1300.0;

/// Basalt-like, thinner by twelve powers of ten when it is hot; latent heat.
Material make_lava() {
  Material m = viscoplastic_material(density, 0.0, 0.0, 1.0, 0.0);
  m.heat = HeatProperties{1e-6, solid_below, liquid_above};
  m.heat->specific_heat = 1200.0;
  m.heat->latent_heat = 4e5;
  m.heat->emissivity = 0.9;
  const auto table = [](double cold, double hot) {
    ThermalRange property;
    property.law = ThermalLaw::table;
    property.temperature = {solid_below, liquid_above};
    property.value = {cold, hot};
    return property;
  };
  m.rheology.yield_stress = table(1e5, 1.0);
  m.rheology.consistency = table(1e9, 30.0);
  m.rheology.jump_number = ThermalRange{10.0, 10.0};
  return m;
}

// A cold ridge 0.2 m wide and 0.1 m high on the ground; hot lava starts on its left half and runs down over both its
// sides.
TEST(Crust, LaterLavaFlowsOverWhatHasSet) {
  auto parameters = make_water_parameters(spacing, 0.25, 0.2);
  parameters.density_diffusion = 0.0;
  parameters.shear_wave_speed = parameters.sound_speed;
  parameters.hourglass_control = 1.0;
  parameters.ambient = Ambient{300.0, 10.0};
  Particles<2> p = make_block<2>({Vec<2>(-0.1, 0.0), Vec<2>(0.1, 0.1)}, spacing, density);
  const std::size_t n_ridge = p.size();
  p.temperature.assign(n_ridge, 900.0);
  const Particles<2> hot = make_block<2>({Vec<2>(-0.1, 0.1), Vec<2>(0.05, 0.25)}, spacing, density);
  for (const Vec<2>& x : hot.position) {
    add_particle<2>(p, x, Vec<2>::Zero(), density);
    p.temperature.push_back(1500.0);
  }
  Colliders<2> colliders;
  Obstacle<2> ground = make_wall({Vec<2>(5.0, 0.0), Vec<2>(-5.0, 0.0)});
  ground.response.friction = 0.0;
  ground.temperature = 300.0;
  colliders.add(std::move(ground));
  std::vector<Vec<2>> start = p.position;
  Solver<2, double> solver(parameters, {make_lava()}, std::move(colliders), std::move(p));
  solver.prepare();
  const int steps = advance_by(solver, full_run() ? 4.0 : 1.0);

  double moved2 = 0.0, farthest = 0.0, left = 0.0, right = 0.0;
  for (std::size_t i = 0; i < solver.particles().size(); ++i) {
    const auto id = static_cast<std::size_t>(solver.particles().id[i]);
    const Vec<2>& x = solver.particles().position[i];
    if (id < n_ridge) {
      moved2 += (x - start[id]).squaredNorm() / static_cast<double>(n_ridge);
      farthest = std::max(farthest, (x - start[id]).norm());
    } else if (x[1] < 0.05) {
      left = std::max(left, -x[0]);
      right = std::max(right, x[0]);
    }
  }
  const std::string resolution = fmt::format("{} particles {} steps", solver.particles().size(), steps);
  report_row({.problem = "hot lava over a cold ridge",
              .quantity = "way of the ridge's particles [spacings]; rms",
              .resolution = resolution,
              .error = std::sqrt(moved2) / spacing,
              .bar = 0.1});
  report_row({.problem = "hot lava over a cold ridge",
              .quantity = "the same; farthest",
              .resolution = resolution,
              .error = farthest / spacing,
              .bar = 0.3});
  EXPECT_GT(left, 0.1 + 2.0 * spacing) << "it ran down on the left";
  EXPECT_GT(right, 0.1 + 2.0 * spacing) << "and on the right";
}

}  // namespace
}  // namespace smelt
