#include "core/sph/rheology.h"
#include "core/sph/stress_update.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace smelt {
namespace {

/// [P 6-1], dimensionless: tau0 = K = gdot1 = 1.
FlowCurve dimensionless(double jump, double index) { return {1.0, 1.0, index, jump + 1.0}; }

TEST(Rheology, ReproducesThePublishedCurve) {
  for (const double jump : {15.0, 150.0, 1500.0}) {
    const FlowCurve curve = dimensionless(jump, 0.5);
    for (const double g : {1e-4, 1e-2, 0.3, 1.0, 20.0}) {
      const double expected = (1.0 - std::exp(-(jump + 1.0) * g)) * (1.0 / std::sqrt(g) + 1.0 / g);
      EXPECT_NEAR(viscosity(curve, g) / expected, 1.0, 1e-10) << "J " << jump << " gdot " << g;
      EXPECT_NEAR(shear_stress(curve, g), viscosity(curve, g) * g, 1e-12 * shear_stress(curve, g));
    }
  }
}

// A plain (1 - exp)/gdot gives 0/0 or noise here; the law's limit is J + 1.
TEST(Rheology, ViscosityAtRestIsFiniteAndRight) {
  const FlowCurve curve = dimensionless(150.0, 1.0);
  for (const double g : {0.0, 1e-300, 1e-20, 1e-14, 1e-12, 1e-9}) EXPECT_NEAR(viscosity(curve, g), 151.0, 151.0 * 1e-6) << g;
}

TEST(Rheology, JumpNumberGivesRestViscosity) {
  Rheology rheology;
  rheology.yield_stress = {50.0, 50.0};
  rheology.consistency = {20.0, 20.0};
  rheology.index = 0.5;
  rheology.jump_number = ThermalRange{150.0, 15.0};
  const double gdot1 = std::pow(50.0 / 20.0, 2.0);
  EXPECT_NEAR(flow_curve_at(rheology, 0.0).rest_viscosity, 151.0 * 50.0 / gdot1, 1e-9);
  EXPECT_NEAR(flow_curve_at(rheology, 1.0).rest_viscosity, 16.0 * 50.0 / gdot1, 1e-9);
}

// [P 6-3] is a line: beyond the melting range it would give a negative J.
TEST(Rheology, MeltedFractionIsClamped) {
  const HeatProperties heat{1e-3, 300.0, 400.0};
  EXPECT_EQ(melted_fraction(heat, 200.0), 0.0);
  EXPECT_DOUBLE_EQ(melted_fraction(heat, 325.0), 0.25);
  EXPECT_EQ(melted_fraction(heat, 5000.0), 1.0);
}

TEST(Rheology, NewtonianAndPowerLawAreLimits) {
  const FlowCurve newtonian{0.0, 7.0, 1.0, 7.0};
  EXPECT_DOUBLE_EQ(viscosity(newtonian, 0.0), 7.0);
  EXPECT_DOUBLE_EQ(viscosity(newtonian, 123.0), 7.0);
  const FlowCurve power_law{0.0, 2.0, 0.5, std::numeric_limits<double>::infinity()};
  EXPECT_NEAR(viscosity(power_law, 4.0), 1.0, 1e-14);
}

TEST(RelaxedShearRate, SolvesItsEquationOverManyDecades) {
  int n_cases = 0;
  for (const double tau0 : {0.0, 1e-3, 50.0, 4e4}) {
    for (const double consistency : {1e-3, 20.0, 4e3}) {
      for (const double index : {0.3, 0.5, 1.0}) {
        for (const double rest : {1e1, 1e4, 1e9}) {
          for (const double modulus_dt : {1e-4, 1.0, 200.0, 1e6}) {
            for (const double trial : {1e-9, 1e-2, 50.0, 3e3, 1e7}) {
              const FlowCurve curve{tau0, consistency, index, rest};
              const double y = relaxed_shear_rate(curve, modulus_dt, trial, 1.0);
              ASSERT_GE(y, 0.0);
              const double residual = std::abs(shear_stress(curve, y) + modulus_dt * y - trial);
              EXPECT_LE(residual, 2e-9 * trial) << fmt::format("tau0 {} K {} n {} eta0 {} Gdt {} trial {}: y {}", tau0, consistency, index,
                                                               rest, modulus_dt, trial, y);
              ++n_cases;
            }
          }
        }
      }
    }
  }
  EXPECT_EQ(n_cases, 4 * 3 * 3 * 3 * 4 * 5);
}

Mat<3> simple_shear(double rate) {
  Mat<3> gradient = Mat<3>::Zero();
  gradient(0, 1) = rate;
  return gradient;
}

TEST(StressUpdate, InstantStressIsTheLaw) {
  const FlowCurve curve = dimensionless(15.0, 0.5);
  const auto state = instant_stress<3>(curve, simple_shear(0.8));
  EXPECT_NEAR(stress_magnitude<3>(state.stress), shear_stress(curve, 0.8), 1e-12);
  EXPECT_NEAR(state.viscosity, viscosity(curve, 0.8), 1e-12);
}

// What makes the relaxed stress legitimate: in steady shear it ends on the flow curve itself. The material turns as it shears, which
// leaves normal stresses of the order of the elastic strain tau/G.
TEST(StressUpdate, RelaxedStressEndsOnTheFlowCurve) {
  const FlowCurve curve = dimensionless(150.0, 0.5);
  for (const double rate : {0.01, 0.3, 4.0}) {
    StressState<3> state{Symmetric<3>::Zero(), 0.0};
    const double modulus = 1e4;
    for (int step = 0; step < 20000; ++step) state = relaxed_stress<3>(curve, modulus, 1e-3, simple_shear(rate), state);
    EXPECT_NEAR(stress_magnitude<3>(state.stress) / shear_stress(curve, rate), 1.0, 1e-4) << "rate " << rate;
  }
}

TEST(StressUpdate, ColdMaterialIsASpring) {
  const FlowCurve solid{1e6, 1e6, 1.0, 1e12};
  StressState<3> state{Symmetric<3>::Zero(), 0.0};
  for (int step = 0; step < 100; ++step) state = relaxed_stress<3>(solid, 1e5, 1e-4, simple_shear(0.1), state);
  // Strain 1e-3 at G = 1e5.
  EXPECT_NEAR(state.stress[symmetric_index<3>(0, 1)], 100.0, 0.1);
}

TEST(StressUpdate, StressTurnsWithTheMaterialAndKeepsItsSize) {
  const FlowCurve solid{1e6, 1e6, 1.0, 1e15};
  Mat<3> spin = Mat<3>::Zero();
  spin(0, 1) = -1.0;
  spin(1, 0) = 1.0;  // 1 rad/s about z
  Mat<3> initial = Mat<3>::Zero();
  initial.diagonal() << 10.0, -10.0, 0.0;
  StressState<3> state{to_symmetric<3>(initial), 1e15};
  const int n_steps = 4000;
  const double dt = 0.5 * 3.14159265358979323846 / n_steps;  // a quarter turn swaps x and y
  for (int step = 0; step < n_steps; ++step) state = relaxed_stress<3>(solid, 1e5, dt, spin, state);
  EXPECT_NEAR(state.stress[0], -10.0, 1e-5);
  EXPECT_NEAR(state.stress[1], 10.0, 1e-5);
  EXPECT_NEAR(state.stress[3], 0.0, 1e-5);
}

}  // namespace
}  // namespace smelt
