#include "core/sph/pair_sums.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

namespace smelt {
namespace {

constexpr double h = 0.7;

/// Two particles a distance apart, with all the fields of a record.
template <int Dim, typename Real>
struct Pair {
  PairFields<Dim, Real> fields;
  NeighbourLists lists;
  double r = 0.0, f = 0.0, w = 0.0;  ///< distance, (dW/dr)/r and W of the scalar kernel

  Pair(KernelType kernel, double distance) {
    using Fields = PairFields<Dim, Real>;
    fields.resize(2, true);
    for (const int k : {0, 1}) {
      Real* record = fields.record(static_cast<std::size_t>(k));
      record[Fields::heat_at] = k == 0 ? Real(1) : Real(3);
      record[Fields::conductivity_at] = k == 0 ? Real(1) : Real(0.6);
      record[Fields::inverse_trace_at] = k == 0 ? Real(2) : Real(0.5);
      record[Fields::balance_at] = k == 0 ? Real(0.2) : Real(-0.3);
      for (int a = 0; a < Dim; ++a) {
        record[a] = k == 0 ? static_cast<Real>(distance / std::sqrt(Dim)) : Real(0);
        record[Fields::velocity_at + a] = k == 0 ? Real(-1) : Real(2 + a);
      }
      record[Fields::volume_at] = Real(0.5);
      record[Fields::density_at] = static_cast<Real>(2 + k);
      record[Fields::specific_pressure_at] = static_cast<Real>(k);
      for (int entry = 0; entry < Dim * Dim; ++entry)
        fields.stress(static_cast<std::size_t>(k))[entry] = static_cast<Real>(1 + entry + k);
    }
    const std::vector<Vec<Dim>> position = {Vec<Dim>::Zero(), Vec<Dim>::Unit(0)};
    build_neighbour_lists<Dim>(position, 2.0, 2.0, pair_lanes<Real>, lists);
    // The distance as the loops see it, rounded.
    double r2 = 0.0;
    for (int a = 0; a < Dim; ++a) r2 += std::pow(static_cast<double>(fields.record(0)[a]), 2);
    r = std::sqrt(r2);
    const Kernel<Dim> scalar(h, kernel);
    f = scalar.derivative(r) / r;
    w = scalar.value(r);
  }
};

template <int Dim, typename Real>
void expect_kernels_agree(double tolerance) {
  for (const KernelType kernel : {KernelType::cubic_spline, KernelType::quintic_spline, KernelType::quadratic}) {
    const Kernel<Dim> scalar(h, kernel);
    for (double distance = 0.01; distance < 3.5 * h; distance += 0.0173) {
      const Pair<Dim, Real> pair(kernel, distance);
      SCOPED_TRACE(testing::Message() << "kernel " << static_cast<int>(kernel) << " in " << Dim
                                      << "D at r/h = " << pair.r / h);
      PairTerms terms;
      terms.kernel = kernel;
      terms.stress = terms.xsph = true;
      terms.heat = HeatTerms::mixed;
      RateSums<Dim, Real> sums[2];
      compute_rate_sums<Dim, Real>(pair.fields, pair.lists, terms, h, 0, 2, sums);
      double approach = 0.0;
      for (int a = 0; a < Dim; ++a) approach += -(3.0 + a) * pair.fields.record(0)[a];
      const double slope_scale = std::abs(scalar.derivative(0.5 * h));
      const double rate_scale = 0.5 * 3.0 * 12.0 * slope_scale;  // v_ij is up to 12
      EXPECT_NEAR(sums[0].density_rate, 0.5 * 3.0 * approach * pair.f, tolerance * rate_scale);
      EXPECT_NEAR(sums[1].density_rate, 0.5 * 2.0 * approach * pair.f, tolerance * rate_scale);
      const double heat_scale = 10.0 * slope_scale / h;  // the quadratic's F peaks where r is some 0.1 h
      // T_0 - T_1 = -2, the mean of 1/theta 1.25, conductivities 1 and 0.6; the pair's own padding (r = 0) must add
      // nothing.
      const double x = pair.fields.record(0)[0], balance = std::clamp(1.0 + x * 0.5, 0.2, 1.8);
      EXPECT_NEAR(sums[0].heat, 2.0 * 0.5 * -2.0 * pair.f * balance * 1.25 * (2.0 * 0.6 / 1.6), tolerance * heat_scale);
      EXPECT_NEAR(sums[0].moment_trace, -0.5 * pair.r * pair.r * pair.f * balance / Dim, tolerance * heat_scale);
      EXPECT_NEAR(sums[0].heat_imbalance[0], 0.5 * pair.f * x * (1.0 + 0.3 * x), tolerance * heat_scale);
      EXPECT_NEAR(sums[0].xsph[0], 0.5 * 0.5 * 3.0 * (1.0 / 2.0 + 1.0 / 3.0) * 3.0 * pair.w,
                  tolerance * scalar.value(0.0));

      std::array<Real, Dim> acceleration[2];
      terms.stress = false;
      using Fields = PairFields<Dim, Real>;
      Fields fields;
      for (const std::size_t k : {0, 1}) {
        fields.records.insert(fields.records.end(), pair.fields.record(k), pair.fields.record(k) + Fields::record_size);
        fields.record(k)[Fields::specific_pressure_at] = k == 0 ? Real(4) : Real(0);
      }
      compute_force_sums<Dim, Real>(fields, pair.lists, terms, {h, 0.0, 1.0}, 0, 2, acceleration);
      for (int a = 0; a < Dim; ++a)
        EXPECT_NEAR(acceleration[0][a], -0.5 * 3.0 * 4.0 * pair.f * pair.fields.record(0)[a],
                    4.0 * tolerance * slope_scale);
    }
  }
}

TEST(PairSums, KernelsAgreeWithTheScalarOnes) {
  expect_kernels_agree<1, double>(1e-13);
  expect_kernels_agree<2, double>(1e-13);
  expect_kernels_agree<3, double>(1e-13);
  // The quintic is a difference of powers up to seven times itself: some twenty roundings of 1.2e-7.
  expect_kernels_agree<3, float>(3e-6);
}

// A particle a hundred times as stiff as its neighbour sees a tenth of it, is seen by it in full, and momentum is kept.
TEST(PairSums, AStressSeesLittleOfWhatIsFarThinner) {
  using Fields = PairFields<3, double>;
  Pair<3, double> pair(KernelType::cubic_spline, 0.6);
  PairTerms terms;
  terms.stress = true;
  RateSums<3, double> sums[2];
  SightedSums<3, double> seen[2];
  terms.sight = true;
  pair.fields.record(0)[Fields::rest_viscosity_at] = 300.0;
  pair.fields.record(1)[Fields::rest_viscosity_at] = 3.0;
  compute_rate_sums<3, double>(pair.fields, pair.lists, terms, h, 0, 2, sums, seen);
  for (const int k : {0, 1}) {
    const double sight = k == 0 ? 0.1 : 1.0;
    EXPECT_NE(sums[k].velocity_moment[1], 0.0);
    EXPECT_NEAR(seen[k].velocity_moment[1] / sums[k].velocity_moment[1], sight, 1e-12);
    EXPECT_NEAR(seen[k].position_moment[1] / sums[k].position_moment[1], sight, 1e-12);
  }
  for (const int k : {0, 1}) {
    double* record = pair.fields.record(static_cast<std::size_t>(k));
    record[Fields::specific_pressure_at] = 0.0;
    record[Fields::rest_viscosity_of_forces_at] = k == 0 ? 300.0 : 3.0;
    record[Fields::rest_viscosity_of_forces_at + 1] = 1.0 / record[Fields::rest_viscosity_of_forces_at];
  }
  std::array<double, 3> acceleration[2];
  compute_force_sums<3, double>(pair.fields, pair.lists, terms, {h, 0.0, 1.0}, 0, 2, acceleration);
  const double x = pair.fields.record(0)[0];
  for (int a = 0; a < 3; ++a) {
    double traction = 0.0;  // S is 1 + its entry, and one more of particle 1
    for (int b = 0; b < 3; ++b) traction += (0.1 * (1 + 3 * a + b) + (2 + 3 * a + b)) * x;
    EXPECT_NEAR(acceleration[0][a], 0.5 / 2.0 * pair.f * traction, 1e-12 * std::abs(pair.f));
    EXPECT_NEAR(2.0 * acceleration[0][a] + 3.0 * acceleration[1][a], 0.0, 1e-12 * std::abs(pair.f));
  }
}

/// A jittered block with neighbours of any number, all fields random.
struct Block {
  PairFields<3, float> fields;
  NeighbourLists lists;
  std::size_t n = 0;

  Block() {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    std::vector<Vec3> position;
    std::vector<std::int32_t> id;
    for (int k = 0; k < 9 * 9 * 9; ++k) {
      id.push_back(k);
      position.push_back(Vec3(k % 9, k / 9 % 9, k / 81) +
                         0.3 * Vec3(uniform(random), uniform(random), uniform(random)));
    }
    const double reach = 2.0 * h * 2.0;
    std::vector<Vec3> sorted;
    for (const std::int32_t k : compute_cell_order<3>(position, id, reach))
      sorted.push_back(position[static_cast<std::size_t>(k)]);
    build_neighbour_lists<3>(sorted, reach, reach, pair_lanes<float>, lists);
    n = sorted.size();
    using Fields = PairFields<3, float>;
    fields.resize(n, true);
    for (float& value : fields.records) value = static_cast<float>(1.5 + uniform(random));
    for (std::size_t i = 0; i < n; ++i)
      for (int a = 0; a < 3; ++a) fields.record(i)[a] = static_cast<float>(sorted[i][a]);
    // Every other particle a thousand times as stiff as the others.
    for (std::size_t i = 0; i < n; i += 2) {
      fields.record(i)[Fields::rest_viscosity_at] *= 1e3F;
      fields.record(i)[Fields::rest_viscosity_of_forces_at] *= 1e3F;
    }
  }
};

TEST(PairSums, EveryInstructionSetGivesTheSameBytes) {
  PairTerms terms;
  terms.stress = terms.hourglass = terms.sight = terms.xsph = true;
  terms.heat = HeatTerms::mixed;
  const Block block;
  const auto evaluate = [&](std::vector<RateSums<3, float>>& rates, std::vector<SightedSums<3, float>>& sighted,
                            std::vector<std::array<float, 3>>& forces) {
    rates.resize(block.n);
    forces.resize(block.n);
    sighted.resize(block.n);
    compute_rate_sums<3, float>(block.fields, block.lists, terms, 2.0 * h, 0, block.n, rates.data(), sighted.data());
    compute_force_sums<3, float>(block.fields, block.lists, terms, {2.0 * h, 0.1, 10.0}, 0, block.n, forces.data());
  };
  std::vector<RateSums<3, float>> widest_rates, rates;
  std::vector<SightedSums<3, float>> widest_sighted, sighted;
  std::vector<std::array<float, 3>> widest_forces, forces;
  evaluate(widest_rates, widest_sighted, widest_forces);
  hwy::SetSupportedTargetsForTest(HWY_AVX2);
  hwy::GetChosenTarget().DeInit();
  evaluate(rates, sighted, forces);
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
  for (std::size_t i = 0; i < block.n; ++i) {
    ASSERT_EQ(std::memcmp(&rates[i], &widest_rates[i], sizeof rates[i]), 0) << "of particle " << i;
    ASSERT_EQ(std::memcmp(&sighted[i], &widest_sighted[i], sizeof sighted[i]), 0) << "of particle " << i;
    ASSERT_EQ(forces[i], widest_forces[i]) << "of particle " << i;
  }
}

}  // namespace
}  // namespace smelt
