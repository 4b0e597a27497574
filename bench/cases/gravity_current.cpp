#include "bench/cases/gravity_current.h"

#include "bench/cases/cpu_clock.h"
#include "bench/cases/norms.h"
#include "bench/cases/reference.h"
#include "bench/cases/set_up.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace smelt::gravity_current {

namespace {

constexpr double inertia = 100.0;
constexpr double gravity = 9.81 / inertia;  ///< [m/s^2]
constexpr double density = 1000.0;          ///< of which nothing depends [kg/m^3]

/// A floor on which nothing slips and, at x = 0, the symmetry plane.
Colliders<2> make_bed() {
  Colliders<2> bed;
  bed.add(make_plane(Vec<2>(40.0, 0.0), Vec<2>(-3.0, 0.0), 0.0));
  bed.add(make_plane(Vec<2>(0.0, 0.0), Vec<2>(0.0, 9.0), 1.0));
  return bed;
}

/// Fluid at rest under `depth(x)` [m] over 0 < x < `length` [m], of kinematic viscosity `viscosity` [m^2/s] and area
/// `area` [m^2], with the pressure of its weight.
template <typename Depth>
Solver<2, double> make_current(const Choices& choices, double viscosity, double area, double length,
                               const Depth& depth) {
  const double c = choices.sound_speed / std::sqrt(inertia);
  auto parameters = make_parameters<2>(choices.spacing, c);
  parameters.smoothing_length = 1.5 * choices.spacing;
  parameters.gravity = Vec<2>(0.0, -gravity);
  parameters.courant = 0.4;
  parameters.shear_wave_speed = choices.shear_wave_speed / std::sqrt(inertia);
  parameters.hourglass_control = 1.0;
  parameters.density_diffusion = 0.1;
  parameters.corrected_divergence = choices.corrected;
  const auto up = [&](double x) { return std::ceil(x / choices.spacing) * choices.spacing; };
  Particles<2> particles =
      make_lattice<2>({Vec<2>(0.0, 0.0), Vec<2>(up(length), up(depth(0.0)))}, choices.spacing, density, 0.0,
                      [&](const Vec<2>& x) { return x[0] < length && x[1] < depth(x[0]); });
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Vec<2>& x = particles.position[i];
    particles.density[i] += density * gravity * (depth(x[0]) - x[1]) / (c * c);
  }
  parameters.particle_volume = area / static_cast<double>(particles.size());
  return {parameters, {newtonian_material(density, density * viscosity / inertia)}, make_bed(), std::move(particles)};
}

double front_of(const Solver<2, double>& solver, double spacing) {
  double front = 0.0;
  for (const Vec<2>& x : solver.particles().position) front = std::max(front, x[0]);
  return front + 0.5 * spacing;
}

/// Follows the front to the times [s], ascending, of the fronts that are expected; the solver starts at `start` [s].
Measurement follow_front(Solver<2, double> solver, double spacing, double start, const Curve& expected) {
  const CpuClock clock;
  Measurement measured{.n_particles = solver.particles().size(), .profile = Profile{{}, expected}};
  solver.prepare(start);
  std::vector<double> differences;
  for (std::size_t k = 0; k < expected.x.size(); ++k) {
    advance_by(solver, expected.x[k] - start, start);
    start = expected.x[k];
    const double front = front_of(solver, spacing);
    measured.profile->computed.add(start, front);
    differences.push_back(front / expected.y[k] - 1.0);
  }
  measured.error = compute_norms(differences).max;
  measured.cpu_seconds = clock.seconds();
  return measured;
}

/// With the corrected divergence, and as scenes have it by default.
Choices choices_of(std::size_t method, double per_metre, double sound_speed) {
  return {1.0 / per_metre, sound_speed, method == 0};
}

}  // namespace

Obstacle<2> make_plane(const Vec<2>& a, const Vec<2>& b, double friction) {
  Obstacle<2> wall;
  wall.facets = {{a, b}};
  wall.wall = wall.closed = true;
  wall.response.friction = friction;
  return wall;
}

Measurement run_plane_current(const Choices& choices) {
  const Reference reference = read_reference("huppert_plane");
  const double start = 10.0, length = reference.at(start);
  const double mean_over_deepest = 0.841309;  // integral of (1 - s^2)^(1/3) over 0 < s < 1
  const auto depth = [&](double x) {
    return std::cbrt(std::max(0.0, 1.0 - x * x / (length * length))) / (mean_over_deepest * length);
  };
  Curve expected;
  for (std::size_t i = 0; i < reference.column[0].size(); ++i) {
    const double t = reference.column[0][i];
    if (t < 31.0 || t > 317.0) continue;
    expected.add(t, reference.column[1][i]);
  }
  return follow_front(make_current(choices, 1.0, 1.0, length, depth), choices.spacing, start, expected);
}

Measurement run_viscous_dam_break(const Choices& choices) {
  const Reference reference = read_reference("lava_bm1_viscous_dam_break");
  const double height = 1.0, length = 6.6;
  const auto depth = [&](double) { return height; };
  return follow_front(make_current(choices, 1e4 / 2700.0, height * length, length, depth), choices.spacing, 0.0,
                      {reference.column[0], reference.column[1]});
}

Case make_plane_case() {
  return {.name = "gravity_current",
          .title = "Plane viscous gravity current",
          .measures = "The front of a fixed volume of viscous fluid that spreads over a floor, from 32 to 316 s, its largest difference from Huppert's "
                      "similarity solution, with and without the corrected divergence.",
          .good = "Within 3 %, with the corrected divergence.",
          .good_error = 0.03,
          .error_label = "front: largest |position / exact - 1|",
          .resolution_label = "particles a metre",
          .profile_x = "time [s]",
          .profile_y = "front [m]",
          .methods = {"corrected divergence", "plain"},
          .quick = {10, 15, 20},
          .full = {12.5, 15, 20, 30},
          .run = [](std::size_t method, double per_metre) { return run_plane_current(choices_of(method, per_metre, 14.0)); }};
}

Case make_benchmark_case() {
  return {.name = "lava_benchmark_1",
          .title = "Lava benchmark 1: viscous dam break",
          .measures = "The front of lava that is let go behind a dam on a flat floor, from 100 to 550 s, its largest difference from the benchmark's "
                      "lubrication theory [Cordonnier 2015], with and without the corrected divergence.",
          .good = "Within 4 %: what is left of inertia is worth 1.6 %.",
          .good_error = 0.04,
          .error_label = "front: largest |position / benchmark - 1|",
          .resolution_label = "particles a metre",
          .profile_x = "time [s]",
          .profile_y = "front [m]",
          .methods = {"corrected divergence", "plain"},
          .quick = {5, 6, 7.5},
          .full = {6, 7.5, 10, 14},
          .run = [](std::size_t method, double per_metre) { return run_viscous_dam_break(choices_of(method, per_metre, 20.0)); }};
}

}  // namespace smelt::gravity_current
