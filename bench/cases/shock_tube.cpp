#include "bench/cases/shock_tube.h"

#include "bench/cases/cpu_clock.h"
#include "bench/cases/reference.h"
#include "core/sph/solver.h"

#include <algorithm>
#include <cmath>

namespace smelt::shock_tube {

namespace {

std::vector<Point> read_points() {
  const Reference reference = read_reference("shock_tube_t0.15");
  std::vector<Point> points(reference.column[0].size());
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = {reference.column[0][i], reference.column[1][i], reference.column[2][i], reference.column[3][i]};
  return points;
}

/// A field of the profile between the two particles around x.
double interpolate(const std::vector<Point>& profile, double Point::*field, double x) {
  const auto above =
      std::lower_bound(profile.begin(), profile.end(), x, [](const Point& p, double at) { return p.x < at; });
  const auto below = above - 1;
  const double t = (x - below->x) / (above->x - below->x);
  return (1.0 - t) * (*below).*field + t * (*above).*field;
}

Measurement run_case(std::size_t, double n_particles) {
  const CpuClock clock;
  const std::vector<Point> profile = simulate(static_cast<int>(n_particles / 400.0));
  const double seconds = clock.seconds();
  Measurement measured{
      .error = density_error(profile), .cpu_seconds = seconds, .n_particles = profile.size(), .profile = Profile()};
  for (const Point& p : profile)
    if (p.x > -0.4 && p.x < 0.4) measured.profile->computed.add(p.x, p.density);
  for (const Point& p : read_points())
    if (p.x > -0.4 && p.x < 0.4) measured.profile->reference.add(p.x, p.density);
  return measured;
}

}  // namespace

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

double density_error(const std::vector<Point>& profile) {
  double error = 0.0, density = 0.0;
  for (const Point& exact : read_points()) {
    if (exact.x < -0.2 || exact.x > 0.25) continue;
    error += std::abs(interpolate(profile, &Point::density, exact.x) - exact.density);
    density += exact.density;
  }
  return error / density;
}

double plateau_error(const std::vector<Point>& profile, double Point::*field, double from, double to) {
  double error = 0.0, expected = 0.0;
  for (const Point& exact : read_points()) {
    if (exact.x < from || exact.x > to) continue;
    error += std::abs(interpolate(profile, field, exact.x) - exact.*field);
    expected += exact.*field;
  }
  return error / expected;
}

Case make_case() {
  return {.name = "shock_tube",
          .title = "Shock tube",
          .measures =
              "The density of an ideal gas 0.15 s after a membrane bursts, between the fan and the shock, against the "
              "exact Riemann solution: mean difference over the mean.",
          .good = "Within 2 %; the order is one at best, as a shock is smeared over so many particles.",
          .good_errors = {0.02},
          .error_label = "density: L1 error / mean",
          .resolution_label = "particles",
          .profile_x = "x [m]",
          .profile_y = "density [kg/m^3]",
          .methods = {"summed density"},
          .quick = {400, 800, 1600, 3200},
          .full = {400, 800, 1600, 3200, 6400},
          .run = run_case};
}

}  // namespace smelt::shock_tube
