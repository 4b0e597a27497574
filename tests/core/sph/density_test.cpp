#include "core/error.h"
#include "core/sph/kernel.h"
#include "core/sph/solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace smelt {
namespace {

constexpr double spacing = 0.05;

SolverParameters<2> make_parameters(DensityForm form) {
  SolverParameters<2> parameters;
  parameters.particle_volume = spacing * spacing;
  parameters.smoothing_length = 1.2 * spacing;
  parameters.sound_speed = 20.0;
  parameters.density = form;
  return parameters;
}

std::vector<Material> two_liquids() {
  Material light{"oil", 800.0, {}, std::nullopt};
  light.rheology.consistency = {0.0, 0.0};
  Material heavy = light;
  heavy.density = 1000.0;
  return {light, heavy};
}

/// A square of 20 x 20 particles, left half light, right half heavy. What it believes its densities to be is nonsense.
Particles<2> make_square(double jitter) {
  Particles<2> p;
  std::mt19937 random(31);
  std::uniform_real_distribution<double> uniform(-jitter, jitter);
  for (int j = 0; j < 20; ++j)
    for (int i = 0; i < 20; ++i) {
      p.id.push_back(static_cast<std::int32_t>(p.id.size()));
      p.material.push_back(i < 10 ? 0 : 1);
      p.position.push_back(spacing * Vec<2>(i + 0.5 + uniform(random), j + 0.5 + uniform(random)));
      p.velocity.push_back(Vec<2>::Zero());
      p.density.push_back(1234.0);
    }
  return p;
}

/// sum m_j W_ij and, with those as densities, the normalised form, over all pairs.
template <typename Solved>
std::pair<std::vector<double>, std::vector<double>> brute_force(const Solved& solver) {
  const Kernel<2> kernel(solver.parameters().smoothing_length, solver.parameters().kernel);
  const auto& x = solver.particles().position;
  std::vector<double> plain(x.size(), 0.0), normalised(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = 0; j < x.size(); ++j) plain[i] += solver.mass(j) * kernel.value((x[i] - x[j]).norm());
  for (std::size_t i = 0; i < x.size(); ++i) {
    double volume = 0.0;
    for (std::size_t j = 0; j < x.size(); ++j) volume += solver.mass(j) / plain[j] * kernel.value((x[i] - x[j]).norm());
    normalised[i] = plain[i] / volume;
  }
  return {plain, normalised};
}

TEST(Density, SumsMatchBruteForce) {
  for (const KernelType kernel : {KernelType::cubic_spline, KernelType::quintic_spline, KernelType::quadratic}) {
    for (const DensityForm form : {DensityForm::summation, DensityForm::normalised_summation}) {
      auto parameters = make_parameters(form);
      parameters.kernel = kernel;
      Solver<2, double> solver(parameters, two_liquids(), {}, make_square(0.2));
      solver.prepare();
      const auto [plain, normalised] = brute_force(solver);
      const auto& expected = form == DensityForm::summation ? plain : normalised;
      for (std::size_t i = 0; i < expected.size(); ++i)
        ASSERT_NEAR(solver.particles().density[i] / expected[i], 1.0, 1e-13);
    }
  }
}

TEST(Density, SumsInSinglePrecisionAreSumsToo) {
  Particles<3> p;
  for (int k = 0; k < 512; ++k) {
    p.id.push_back(k);
    p.position.push_back(spacing * Vec3(k % 8, k / 8 % 8, k / 64));
    p.velocity.push_back(Vec3::Zero());
    p.density.push_back(1.0);
  }
  SolverParameters<3> parameters;
  parameters.particle_volume = std::pow(spacing, 3);
  parameters.smoothing_length = 1.2 * spacing;
  parameters.sound_speed = 20.0;
  parameters.density = DensityForm::summation;
  Solver<3, float> single(parameters, {two_liquids()[1]}, {}, p);
  Solver<3, double> twice(parameters, {two_liquids()[1]}, {}, p);
  single.prepare();
  twice.prepare();
  for (std::size_t i = 0; i < p.size(); ++i)
    ASSERT_NEAR(single.particles().density[i] / twice.particles().density[i], 1.0, 2e-6);
}

/// Density at rest of a lattice in a periodic box, stretched by `stretch` along both axes after the masses were given.
double lattice_density(DensityForm form, double stretch) {
  auto parameters = make_parameters(form);
  parameters.period.lower.setZero();
  parameters.period.upper.setConstant(20 * spacing * stretch);
  Particles<2> p = make_square(0.0);
  p.material.assign(p.size(), 1);
  p.density.assign(p.size(), 1000.0);
  for (auto& x : p.position) x *= stretch;
  Solver<2, double> solver(parameters, two_liquids(), {}, p);
  // More than one step: nothing may remember what the density was.
  for (int k = 0; k < 3; ++k) {
    solver.prepare();
    solver.step(1e-6, 0.0);
  }
  return solver.particles().density[0];
}

// With [S 4.20]'s densities of the step before the normalised form stays at 1000 however much the lattice is squeezed.
TEST(Density, SumsFollowCompression) {
  for (const DensityForm form : {DensityForm::summation, DensityForm::normalised_summation}) {
    const double rest = lattice_density(form, 1.0);
    EXPECT_NEAR(rest, 1000.0, 5.0);
    EXPECT_NEAR(lattice_density(form, 0.98) / rest, 1.0 / (0.98 * 0.98), 5e-3);
  }
}

TEST(Density, NormalisingHelpsAtAFreeSurface) {
  const auto worst = [](DensityForm form) {
    Particles<2> p = make_square(0.0);
    p.material.assign(p.size(), 1);
    Solver<2, double> solver(make_parameters(form), two_liquids(), {}, p);
    solver.prepare();
    return *std::min_element(solver.particles().density.begin(), solver.particles().density.end());
  };
  // At a corner a little over a quarter of the support is there, and the particle itself weighs more than its share.
  const double plain = worst(DensityForm::summation), normalised = worst(DensityForm::normalised_summation);
  EXPECT_GT(plain, 500.0);
  EXPECT_LT(plain, 700.0);
  EXPECT_GT(normalised, plain + 50.0);
  EXPECT_LT(normalised, 1000.0);
}

TEST(Density, ContinuityTakesNoSums) {
  Particles<2> p = make_square(0.1);
  Solver<2, double> solver(make_parameters(DensityForm::continuity), two_liquids(), {}, p);
  solver.prepare();
  for (const double rho : solver.particles().density) ASSERT_EQ(rho, 1234.0);
}

}  // namespace
}  // namespace smelt
