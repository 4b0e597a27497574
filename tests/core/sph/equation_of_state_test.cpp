#include "core/sph/equation_of_state.h"

#include "core/sph/solver.h"

#include <gtest/gtest.h>

namespace smelt {
namespace {

constexpr double c = 30.0, rho0 = 900.0;

TEST(EquationOfState, LiquidsRestAtTheirDensityAndStiffenAsSaid) {
  EXPECT_EQ(linear_pressure(c, rho0, rho0), 0.0);
  EXPECT_EQ(tait_pressure(c, rho0, rho0), 0.0);
  EXPECT_DOUBLE_EQ(linear_pressure(c, rho0, 1.01 * rho0), 0.01 * rho0 * c * c);
  // By hand: 1.1^7 = 1.9487171.
  EXPECT_NEAR(tait_pressure(c, rho0, 1.1 * rho0), c * c * rho0 / 7.0 * 0.9487171, 1e-6);
  EXPECT_DOUBLE_EQ(ideal_gas_pressure(1.4, 0.25, 1.795), 0.1795);
}

// For all laws the sound speed is that of the pressure's slope: along rho for liquids, along an adiabat (e ~
// rho^(gamma-1)) for a gas.
TEST(EquationOfState, SoundSpeedIsTheSlopeOfThePressure) {
  for (const PressureLaw law : {PressureLaw::linear, PressureLaw::tait, PressureLaw::ideal_gas}) {
    const EquationOfState state{law, 123.0, 1.67};
    for (const double rho : {0.8 * rho0, rho0, 1.2 * rho0}) {
      const double eps = 1e-5 * rho;
      const auto adiabat = [&](double r) { return 2.5 * std::pow(r / rho, 0.67); };
      const double slope = (compute_pressure(state, c, rho0, rho + eps, adiabat(rho + eps)) -
                            compute_pressure(state, c, rho0, rho - eps, adiabat(rho - eps))) /
                           (2.0 * eps);
      EXPECT_NEAR(compute_sound_speed(state, c, rho0, rho, 2.5) / std::sqrt(slope), 1.0, 1e-7) << static_cast<int>(law);
    }
  }
}

TEST(EquationOfState, BackgroundPressureIsAddedForLiquidsOnly) {
  const auto difference = [](PressureLaw law) {
    return compute_pressure({law, 500.0, 1.4}, c, rho0, 950.0, 2.0) -
           compute_pressure({law, 0.0, 1.4}, c, rho0, 950.0, 2.0);
  };
  EXPECT_NEAR(difference(PressureLaw::linear), 500.0, 1e-9);
  EXPECT_NEAR(difference(PressureLaw::tait), 500.0, 1e-9);
  EXPECT_EQ(difference(PressureLaw::ideal_gas), 0.0);
}

/// Two particles at one density: what pushes them apart is their pressure.
double push(const EquationOfState& state, double density) {
  Particles<1> p;
  p.id = {0, 1};
  p.position = {Vec<1>(0.0), Vec<1>(0.1)};
  p.velocity = {Vec<1>::Zero(), Vec<1>::Zero()};
  p.density = {density, density};
  SolverParameters<1> parameters;
  parameters.particle_volume = 0.1;
  parameters.smoothing_length = 0.12;
  parameters.sound_speed = c;
  parameters.equation_of_state = state;
  Material m{"water", rho0, {}, std::nullopt};
  m.rheology.consistency = {0.0, 0.0};
  Solver<1, double> solver(parameters, {m}, {}, p);
  solver.prepare();
  return solver.acceleration(1)[0];
}

TEST(EquationOfState, SolverUsesTheLawItIsGiven) {
  const double linear = push({}, 1.1 * rho0);
  EXPECT_GT(linear, 0.0);
  EXPECT_NEAR(push({PressureLaw::tait, 0.0, 1.4}, 1.1 * rho0) / linear, 0.9487171 / 0.7, 1e-9);
  EXPECT_NEAR(push({PressureLaw::linear, 81000.0, 1.4}, 1.1 * rho0) / linear, 2.0, 1e-9);
}

}  // namespace
}  // namespace smelt
