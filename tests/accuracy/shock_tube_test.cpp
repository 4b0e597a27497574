// The shock tube of [S 4.5.1], table 5: density by summation, energy equation, artificial viscosity, against the exact
// Riemann solution.

#include "core/sph/solver.h"
#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace smelt {
namespace {

/// State of the gas at a place. Units as in the reference file.
struct Point {
  double x = 0.0, density = 0.0, velocity = 0.0, pressure = 0.0;
};

std::vector<Point> read_points() {
  const Reference reference = read_reference("shock_tube_t0.15");
  std::vector<Point> points(reference.column[0].size());
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = {reference.column[0][i], reference.column[1][i], reference.column[2][i], reference.column[3][i]};
  return points;
}

/// [S]'s tube: particles of equal mass, `refinement` times as fine as its 400, h twice the wider spacing. The tube has
/// a mirror image behind its left end and repeats, so that it has no ends whose waves would have to be cut off:
/// membranes at x = 0 and x = -1.2.
std::vector<Point> simulate(int refinement) {
  const double left_spacing = 0.001875 / refinement, right_spacing = 4.0 * left_spacing, gamma = 1.4;
  SolverParameters<1> parameters;
  parameters.particle_volume = left_spacing;
  parameters.smoothing_length = 2.0 * right_spacing;
  parameters.equation_of_state = {PressureLaw::ideal_gas, 0.0, gamma};
  parameters.density = DensityForm::summation;
  parameters.artificial_viscosity = 1.0;
  parameters.quadratic_artificial_viscosity = 2.0;
  parameters.period.lower[0] = -1.8;
  parameters.period.upper[0] = 0.6;
  Particles<1> particles;
  const auto fill = [&](double lower, double upper, double spacing, double density, double energy) {
    for (double x = lower + 0.5 * spacing; x < upper; x += spacing) {
      particles.id.push_back(static_cast<std::int32_t>(particles.id.size()));
      particles.position.push_back(Vec<1>(x));
      particles.velocity.push_back(Vec<1>::Zero());
      particles.density.push_back(density);
      particles.internal_energy.push_back(energy);
    }
  };
  fill(-1.8, -1.2, right_spacing, 0.25, 1.795);
  fill(-1.2, 0.0, left_spacing, 1.0, 2.5);
  fill(0.0, 0.6, right_spacing, 0.25, 1.795);

  Material gas{"gas", 1.0, {}, std::nullopt};
  gas.rheology.consistency = {0.0, 0.0};
  Solver<1, double> solver(parameters, {gas}, {}, particles);
  solver.prepare();
  for (double remaining = 0.15; remaining > 0.0;) remaining -= solver.step(remaining, 0.15 - remaining).dt;

  const auto& q = solver.particles();
  std::vector<Point> profile;
  for (std::size_t i = 0; i < q.size(); ++i)
    if (q.position[i][0] > -0.6)
      profile.push_back({q.position[i][0], q.density[i], q.velocity[i][0],
                         ideal_gas_pressure(gamma, q.density[i], q.internal_energy[i])});
  std::sort(profile.begin(), profile.end(), [](const Point& a, const Point& b) { return a.x < b.x; });
  return profile;
}

/// A field of the profile between the two particles around x.
double interpolate(const std::vector<Point>& profile, double Point::*field, double x) {
  const auto above =
      std::lower_bound(profile.begin(), profile.end(), x, [](const Point& p, double at) { return p.x < at; });
  const auto below = above - 1;
  const double t = (x - below->x) / (above->x - below->x);
  return (1.0 - t) * (*below).*field + t * (*above).*field;
}

/// Mean of |rho - rho_exact| over mean rho, over the waves and what they are smeared by: the fan begins at x = -0.178,
/// the shock is at 0.222.
double density_error(const std::vector<Point>& profile) {
  double error = 0.0, density = 0.0;
  for (const Point& exact : read_points()) {
    if (exact.x < -0.2 || exact.x > 0.25) continue;
    error += std::abs(interpolate(profile, &Point::density, exact.x) - exact.density);
    density += exact.density;
  }
  return error / density;
}

/// Mean of |f - f_exact| over mean f on a plateau, so that errors of either sign count.
double plateau_error(const std::vector<Point>& profile, double Point::*field, double from, double to) {
  double error = 0.0, expected = 0.0;
  for (const Point& exact : read_points()) {
    if (exact.x < from || exact.x > to) continue;
    error += std::abs(interpolate(profile, field, exact.x) - exact.*field);
    expected += exact.*field;
  }
  return error / expected;
}

TEST(ShockTube, ConvergesToTheRiemannSolution) {
  double previous = 0.0;
  for (const int refinement : {1, 2, 4}) {
    const auto profile = simulate(refinement);
    // [S]'s own 400 particles are measured without a bar, for comparison with its figures 16-19.
    const bool barred = refinement > 1;
    const auto report = [&](const std::string& quantity, double error, double bar) {
      report_row({.problem = "shock tube", .quantity = quantity, .resolution = fmt::format("{} particles", 400 * refinement), .error = error,
                  .bar = barred ? std::optional(bar) : std::nullopt});
    };
    const double l1 = density_error(profile);
    // A shock and a contact are smeared over a fixed number of particles: order one at best.
    report_row({.problem = "shock tube", .quantity = "density L1 / mean", .resolution = fmt::format("{} particles", 400 * refinement), .error = l1,
                .bar = barred ? std::optional(0.02) : std::nullopt,
                .order = barred ? std::optional(std::log2(previous / l1)) : std::nullopt,
                .least_order = barred ? std::optional(0.85) : std::nullopt});
    previous = l1;
    // The fan ends at -0.057, the contact is at 0.101, the shock at 0.222.
    report("plateau left of the contact; density", plateau_error(profile, &Point::density, -0.03, 0.07), 0.01);
    report("plateau right of the contact; density", plateau_error(profile, &Point::density, 0.13, 0.19), 0.01);
    report("plateau; velocity", plateau_error(profile, &Point::velocity, -0.03, 0.19), 0.01);
    report("plateau; pressure", plateau_error(profile, &Point::pressure, -0.03, 0.19), 0.01);
  }
}

}  // namespace
}  // namespace smelt
