// The lid-driven square cavity at Re = 1 [S 4.5.2] against finite differences: four walls, one of which slides.

#include "core/sph/kernel.h"
#include "tests/accuracy/measure.h"
#include "tests/accuracy/set_up.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace smelt {
namespace {

// Side, lid speed, density and viscosity are 1.

/// The box at rest. Its facets run clockwise, so that they face the fluid.
Solver<2, double> make_cavity(int across) {
  const double spacing = 1.0 / across;
  // At ten times the lid's speed the viscous pressures of Re = 1 would squeeze the fluid by a fifth; a higher sound
  // speed costs nothing, as viscosity limits the step.
  auto parameters = make_parameters<2>(spacing, 50.0);
  parameters.smoothing_length = 1.4 * spacing;
  parameters.courant = 0.4;
  parameters.hourglass_control = 1.0;
  parameters.density_diffusion = 0.3;
  parameters.xsph = 0.5;
  const Vec<2> a(0.0, 0.0), b(1.0, 0.0), c(1.0, 1.0), d(0.0, 1.0);
  Obstacle<2> walls{{{a, d}, {c, b}, {b, a}}}, lid{{{d, c}}};
  walls.wall = walls.closed = lid.wall = lid.closed = true;
  lid.surface_velocity = Vec<2>(1.0, 0.0);
  Colliders<2> colliders;
  colliders.add(std::move(walls));
  colliders.add(std::move(lid));
  return {parameters, {newtonian_material(1.0, 1.0)}, std::move(colliders), make_block<2>({a, c}, spacing, 1.0)};
}

/// Mean of the velocities around `x`, weighted by the kernel [Shepard].
Vec<2> interpolate(const Solver<2, double>& solver, const Vec<2>& x) {
  const auto& p = solver.particles();
  const Kernel<2> kernel(solver.parameters().smoothing_length);
  Vec<2> sum = Vec<2>::Zero();
  double weight = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double w = kernel.value((p.position[i] - x).norm()) / p.density[i];
    sum += w * p.velocity[i];
    weight += w;
  }
  return sum / weight;
}

struct Measured {
  double u = 0.0;  // largest difference on x = 0.5
  double v = 0.0;  // on y = 0.5
};

/// From one spacing off the walls on: nearer, a mean of the fluid is one-sided.
Measured measure(const Solver<2, double>& solver, const Reference& reference, int across) {
  Measured largest;
  for (const double s : reference.column[0]) {
    if (std::min(s, 1.0 - s) < 1.0 / across) continue;
    largest.u = std::max(largest.u, std::abs(interpolate(solver, Vec<2>(0.5, s))[0] - reference.at(s, 1)));
    largest.v = std::max(largest.v, std::abs(interpolate(solver, Vec<2>(s, 0.5))[1] - reference.at(s, 2)));
  }
  return largest;
}

void report(const Measured& measured, double time, int across, std::optional<double> bar) {
  const std::string problem = fmt::format("lid-driven cavity; Re = 1; after {} L/U", time),
                    resolution = fmt::format("{0} x {0}", across);
  report_row({.problem = problem,
              .quantity = "u on x = 0.5; max / U",
              .resolution = resolution,
              .error = measured.u,
              .bar = bar});
  report_row({.problem = problem,
              .quantity = "v on y = 0.5; max / U",
              .resolution = resolution,
              .error = measured.v,
              .bar = bar});
}

// By 0.3 L/U the flow is steady: its slowest mode decays as exp(-52 t). Later the particles gather in strings near the
// lid's far corner and thin out below its near one, for which there is a row and no bar.
TEST(Cavity, FollowsTheSlidingLid) {
  constexpr int across = 40;
  const Reference reference = read_reference("cavity_re1_centrelines");
  Solver<2, double> solver = make_cavity(across);
  solver.prepare();
  advance_by(solver, 0.3);
  report(measure(solver, reference, across), 0.3, across, 0.02);
  advance_by(solver, 0.2, 0.3);
  report(measure(solver, reference, across), 0.5, across, {});
}

}  // namespace
}  // namespace smelt
