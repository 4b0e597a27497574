#include "core/sph/rheology.h"

#include "core/sph/gradient_correction.h"
#include "core/sph/stress_update.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <random>

namespace smelt {
namespace {

/// [P 6-1], dimensionless: tau0 = K = gdot1 = 1.
FlowCurve dimensionless(double jump, double index) {
  return {1.0, 1.0, index, jump + 1.0};
}

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
  for (const double g : {0.0, 1e-300, 1e-20, 1e-14, 1e-12, 1e-9})
    EXPECT_NEAR(viscosity(curve, g), 151.0, 151.0 * 1e-6) << g;
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
              EXPECT_LE(residual, 2e-9 * trial) << fmt::format("tau0 {} K {} n {} eta0 {} Gdt {} trial {}: y {}", tau0,
                                                               consistency, index, rest, modulus_dt, trial, y);
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

// What makes the relaxed stress legitimate: in steady shear it ends on the flow curve itself. The material turns as it
// shears, which leaves normal stresses of the order of the elastic strain tau/G.
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

/// Solids, liquids and what is between them, some of it turning, with powers that have fast paths and one that has
/// none.
StressBlock<3> make_mixed_block() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  StressBlock<3> block{};
  block.size = 29;  // not a whole number of vectors
  for (std::size_t k = 0; k < block.size; ++k) {
    const double speed = std::pow(10.0, 3.0 * uniform(random));
    for (auto& entry : block.gradient) entry[k] = speed * uniform(random);
    Mat<3> stress = Mat<3>::NullaryExpr([&] { return 50.0 * uniform(random); });
    stress += stress.transpose().eval();
    for (int m = 0; m < 6; ++m) block.stress[static_cast<std::size_t>(m)][k] = to_symmetric<3>(stress)[m];
    block.viscosity[k] = k % 7 == 0 ? 0.0 : 1e3 * (1.1 + uniform(random));
    const double yields[] = {0.0, 5.0, 3e4}, indices[] = {0.5, 1.0, 0.3};
    block.set_curve(k, {yields[k % 3], 20.0, indices[k / 3 % 3], k % 5 == 0 ? 1e9 : 1e4});
    block.modulus[k] = 1e5;
  }
  return block;
}

TEST(StressUpdate, BytesDependNeitherOnCompanyNorOnInstructions) {
  constexpr double dt = 1e-4;
  const StressBlock<3> before = make_mixed_block();
  StressBlock<3> widest = before, narrow = before;
  relax_stresses<3>(dt, widest);
  hwy::SetSupportedTargetsForTest(HWY_AVX2);
  hwy::GetChosenTarget().DeInit();
  relax_stresses<3>(dt, narrow);
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
  for (std::size_t k = 0; k < before.size; ++k) {
    Mat<3> gradient;
    StressState<3> state{Symmetric<3>::Zero(), before.viscosity[k]};
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) gradient(a, b) = before.gradient[static_cast<std::size_t>(a * 3 + b)][k];
    for (std::size_t m = 0; m < 6; ++m) state.stress[static_cast<Eigen::Index>(m)] = before.stress[m][k];
    const StressState<3> alone = relaxed_stress<3>(before.curve(k), before.modulus[k], dt, gradient, state);
    for (std::size_t m = 0; m < 6; ++m) {
      EXPECT_EQ(widest.stress[m][k], narrow.stress[m][k]) << "particle " << k << " entry " << m;
      EXPECT_EQ(widest.stress[m][k], alone.stress[static_cast<Eigen::Index>(m)]) << "particle " << k << " entry " << m;
    }
    EXPECT_EQ(widest.viscosity[k], narrow.viscosity[k]) << "particle " << k;
    EXPECT_EQ(widest.viscosity[k], alone.viscosity) << "particle " << k;
    // |S| and eta are of the law: S is what the spring holds at the dashpot's rate.
    const double rate = stress_magnitude<3>(alone.stress) / alone.viscosity;
    EXPECT_NEAR(shear_stress(before.curve(k), rate) / stress_magnitude<3>(alone.stress), 1.0, 1e-6) << "particle " << k;
  }
}

/// Moments as in the bulk, at surfaces, and of sheets, threads and lone particles, which have too few neighbours.
template <int Dim>
void expect_inverse_moments() {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  StressBlock<Dim> block{};
  block.size = 27;
  for (std::size_t k = 0; k < block.size; ++k) {
    Mat<Dim> any = Mat<Dim>::NullaryExpr([&] { return uniform(random); });
    any += any.transpose().eval();
    const Mat<Dim> axes = Eigen::SelfAdjointEigenSolver<Mat<Dim>>(any).eigenvectors();
    Vec<Dim> eigenvalues;
    for (int a = 0; a < Dim; ++a)
      eigenvalues[a] = static_cast<int>(k % 4) > a ? 0.09 * uniform(random) : 0.2 + uniform(random);
    const Symmetric<Dim> moment = to_symmetric<Dim>(axes * eigenvalues.asDiagonal() * axes.transpose());
    for (std::size_t m = 0; m < n_symmetric<Dim>; ++m) block.moment[m][k] = moment[static_cast<Eigen::Index>(m)];
  }
  StressBlock<Dim> narrow = block;
  invert_moments<Dim>(block);
  hwy::SetSupportedTargetsForTest(HWY_AVX2);
  hwy::GetChosenTarget().DeInit();
  invert_moments<Dim>(narrow);
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
  for (std::size_t k = 0; k < block.size; ++k) {
    Symmetric<Dim> moment;
    for (std::size_t m = 0; m < n_symmetric<Dim>; ++m) moment[static_cast<Eigen::Index>(m)] = block.moment[m][k];
    const Mat<Dim> expected = compute_gradient_correction<Dim>(to_matrix<Dim>(moment));
    EXPECT_LT((block.correction_of(k) - expected).norm(), 1e-12 * (1.0 + expected.norm()))
        << Dim << "D, particle " << k;
    EXPECT_EQ(block.correction_of(k), narrow.correction_of(k)) << Dim << "D, particle " << k;
  }
  for (std::size_t k = block.size; k < block.capacity; ++k)
    EXPECT_TRUE(block.correction_of(k).isZero(0.0)) << "what fills a vector stays harmless";
}

TEST(StressUpdate, MomentsAreInvertedAsOneByOne) {
  expect_inverse_moments<1>();
  expect_inverse_moments<2>();
  expect_inverse_moments<3>();
}

}  // namespace
}  // namespace smelt
