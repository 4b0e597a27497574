// Lone particles under gravity: leap-frog is exact for a constant acceleration, whatever the steps.

#include "bench/cases/set_up.h"
#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace smelt {
namespace {

struct FlightError {
  double position = 0.0;  ///< largest |x - (x0 + v0 t + g t^2/2)| over the way flown
  double velocity = 0.0;  ///< largest |v - (v0 + g t)| / |g t|
  double density = 0.0;   ///< largest |rho/rho0 - 1|
  int steps = 0;
};

/// 27 viscoplastic particles ten smoothing lengths apart, thrown with `speed` [m/s] in different directions.
template <typename Real>
FlightError fly(double speed) {
  constexpr double spacing = 0.05, duration = 0.7, h = 1.2 * spacing;
  const Box<3> box{Vec3::Constant(-15.0 * h), Vec3::Constant(15.0 * h)};
  Particles<3> p = make_block<3>(box, 10.0 * h, 1000.0);
  // Outward, so that they never meet.
  for (std::size_t i = 0; i < p.size(); ++i) p.velocity[i] = speed * p.position[i] / (15.0 * h);
  auto parameters = make_parameters<3>(spacing, 20.0);
  parameters.gravity = Vec3(0.4, -9.81, 0.2);
  parameters.shear_wave_speed = 20.0;
  parameters.artificial_viscosity = 0.5;
  parameters.xsph = 0.5;
  const Particles<3> start = p;
  Solver<3, Real> solver(parameters, {viscoplastic_material(1000.0, 100.0, 50.0, 0.5, 1000.0)}, {}, std::move(p));
  solver.prepare();
  FlightError error;
  error.steps = advance_by(solver, duration);
  const Particles<3>& q = solver.particles();
  for (std::size_t i = 0; i < q.size(); ++i) {
    const auto id = static_cast<std::size_t>(q.id[i]);
    const Vec3 way = duration * start.velocity[id] + 0.5 * duration * duration * parameters.gravity;
    const Vec3 gain = duration * parameters.gravity;
    error.position = std::max(error.position, (q.position[i] - start.position[id] - way).norm() / way.norm());
    error.velocity = std::max(error.velocity, (q.velocity[i] - start.velocity[id] - gain).norm() / gain.norm());
    error.density = std::max(error.density, std::abs(q.density[i] / 1000.0 - 1.0));
  }
  return error;
}

// The state is double whatever the pair loops compute in: a particle without neighbours sums exact zeros.
void report_flight(const char* problem, double speed) {
  for (const auto& [real, error] : {std::pair{"double", fly<double>(speed)}, std::pair{"float", fly<float>(speed)}}) {
    report_row({.problem = problem,
                .quantity = "position / way flown",
                .resolution = fmt::format("{} steps in {}", error.steps, real),
                .error = error.position,
                .bar = 1e-12});
    report_row({.problem = problem,
                .quantity = "velocity / velocity gained",
                .resolution = fmt::format("{} steps in {}", error.steps, real),
                .error = error.velocity,
                .bar = 1e-12});
    EXPECT_EQ(error.density, 0.0);
  }
}

TEST(FreeFlight, Fall) {
  report_flight("free fall", 0.0);
}
TEST(FreeFlight, Projectile) {
  report_flight("projectile", 4.0);
}

}  // namespace
}  // namespace smelt
