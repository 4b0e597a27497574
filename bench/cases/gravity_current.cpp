#include "bench/cases/gravity_current.h"

#include "bench/cases/cpu_clock.h"
#include "bench/cases/norms.h"
#include "bench/cases/reference.h"
#include "bench/cases/set_up.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace smelt::gravity_current {

namespace {

constexpr double inertia = 100.0;
constexpr double gravity = 9.81 / inertia;  ///< [m/s^2]
constexpr double density = 1000.0;          ///< of which nothing depends [kg/m^3]

/// A floor on which nothing slips and, at x = 0, the symmetry plane.
Colliders<2> make_bed(Colliders<2> bed) {
  bed.add(make_plane(Vec<2>(40.0, 0.0), Vec<2>(-3.0, 0.0), 0.0));
  bed.add(make_plane(Vec<2>(0.0, 0.0), Vec<2>(0.0, 9.0), 1.0));
  return bed;
}

/// A rectangle from corner `a` along `u` and `v` [m], which faces u x v.
Obstacle<3> make_rectangle(const Vec3& a, const Vec3& u, const Vec3& v, double friction) {
  Obstacle<3> wall;
  wall.facets = {{a, a + u, a + u + v}, {a, a + u + v, a + v}};
  wall.wall = wall.closed = true;
  wall.response.friction = friction;
  return wall;
}

/// The same, with symmetry planes at x = 0 and z = 0: a quarter of what spreads in all directions.
Colliders<3> make_bed(Colliders<3> bed) {
  bed.add(make_rectangle(Vec3(-1.0, 0.0, -1.0), Vec3(0.0, 0.0, 9.0), Vec3(9.0, 0.0, 0.0), 0.0));
  bed.add(make_rectangle(Vec3(0.0, -1.0, -1.0), Vec3(0.0, 5.0, 0.0), Vec3(0.0, 0.0, 9.0), 1.0));
  bed.add(make_rectangle(Vec3(-1.0, -1.0, 0.0), Vec3(9.0, 0.0, 0.0), Vec3(0.0, 5.0, 0.0), 1.0));
  return bed;
}

/// How far `x` is from where the current spreads from [m].
double way_of(const Vec<2>& x) {
  return x[0];
}
double way_of(const Vec3& x) {
  return std::hypot(x[0], x[2]);
}

/// Fluid at rest under `depth(way)` [m] as far as `length` [m], of kinematic viscosity `viscosity` [m^2/s] and volume
/// `volume` [m^Dim], with the pressure of its weight.
template <int Dim, typename Depth>
Solver<Dim, double> make_current(const Choices& choices, double viscosity, double volume, double length,
                                 const Depth& depth) {
  const double c = choices.sound_speed / std::sqrt(inertia);
  auto parameters = make_parameters<Dim>(choices.spacing, c);
  parameters.smoothing_length = 1.5 * choices.spacing;
  parameters.gravity[1] = -gravity;
  parameters.courant = 0.4;
  parameters.shear_wave_speed = choices.shear_wave_speed / std::sqrt(inertia);
  parameters.hourglass_control = 1.0;
  parameters.density_diffusion = 0.1;
  parameters.corrected_divergence = choices.corrected;
  const auto up = [&](double x) { return std::ceil(x / choices.spacing) * choices.spacing; };
  Box<Dim> box{Vec<Dim>::Zero(), Vec<Dim>::Constant(up(length))};
  box.upper[1] = up(depth(0.0));
  Particles<Dim> particles = make_lattice<Dim>(box, choices.spacing, density, 0.0, [&](const Vec<Dim>& x) {
    return way_of(x) < length && x[1] < depth(way_of(x));
  });
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Vec<Dim>& x = particles.position[i];
    particles.density[i] += density * gravity * (depth(way_of(x)) - x[1]) / (c * c);
  }
  parameters.particle_volume = volume / static_cast<double>(particles.size());
  return {parameters,
          {newtonian_material(density, density * viscosity / inertia)},
          make_bed(Colliders<Dim>()),
          std::move(particles)};
}

template <int Dim>
double front_of(const Solver<Dim, double>& solver, double spacing) {
  double front = 0.0;
  for (const Vec<Dim>& x : solver.particles().position) front = std::max(front, way_of(x));
  return front + 0.5 * spacing;
}

/// Follows the front to the times [s], ascending, of the fronts that are expected; the solver starts at `start` [s].
template <int Dim>
Measurement follow_front(Solver<Dim, double> solver, double spacing, double start, const Curve& expected) {
  const CpuClock clock;
  Measurement measured{.n_particles = solver.particles().size(), .profile = Profile{{}, expected}};
  solver.prepare(start);
  std::vector<double> differences;
  for (std::size_t k = 0; k < expected.x.size(); ++k) {
    advance_by(solver, expected.x[k] - start, start);
    start = expected.x[k];
    const double front = front_of<Dim>(solver, spacing);
    measured.profile->computed.add(start, front);
    differences.push_back(front / expected.y[k] - 1.0);
  }
  measured.error = compute_norms(differences).max;
  measured.cpu_seconds = clock.seconds();
  return measured;
}

/// The reference's fronts between two times [s].
Curve fronts(const Reference& reference, double from, double to) {
  Curve curve;
  for (std::size_t i = 0; i < reference.column[0].size(); ++i)
    if (reference.column[0][i] >= from && reference.column[0][i] <= to)
      curve.add(reference.column[0][i], reference.column[1][i]);
  return curve;
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
  return follow_front(make_current<2>(choices, 1.0, 1.0, length, depth), choices.spacing, start,
                      fronts(reference, 31.0, 317.0));
}

Measurement run_axisymmetric_current(const Choices& choices) {
  const Reference reference = read_reference("huppert_axisymmetric");
  const double start = 10.0, length = reference.at(start);
  constexpr double quarter = 0.25;  // of the volume, 1 m^3
  const auto depth = [&](double r) {
    return 4.0 / (3.0 * std::numbers::pi * length * length) * std::cbrt(std::max(0.0, 1.0 - r * r / (length * length)));
  };
  return follow_front(make_current<3>(choices, 1.0, quarter, length, depth), choices.spacing, start,
                      fronts(reference, 15.0, 65.0));
}

Measurement run_viscous_dam_break(const Choices& choices) {
  const Reference reference = read_reference("lava_bm1_viscous_dam_break");
  const double height = 1.0, length = 6.6;
  const auto depth = [&](double) { return height; };
  return follow_front(make_current<2>(choices, 1e4 / 2700.0, height * length, length, depth), choices.spacing, 0.0,
                      {reference.column[0], reference.column[1]});
}

Case make_plane_case() {
  return {.name = "gravity_current",
          .title = "Plane viscous gravity current",
          .measures =
              "The front of a fixed volume of viscous fluid that spreads over a floor, from 32 to 316 s, its largest "
              "difference from Huppert's similarity solution, with and without the corrected divergence.",
          .good = "Within 3 %, with the corrected divergence.",
          .good_errors = {0.03},
          .error_label = "front: largest |position / exact - 1|",
          .resolution_label = "particles a metre",
          .profile_x = "time [s]",
          .profile_y = "front [m]",
          .methods = {"corrected divergence", "plain"},
          .quick = {10, 15, 20},
          .full = {12.5, 15, 20, 30},
          .run = [](std::size_t method, double per_metre) {
            return run_plane_current(choices_of(method, per_metre, 14.0));
          }};
}

Case make_axisymmetric_case() {
  return {
      .name = "axisymmetric_current",
      .title = "Axisymmetric viscous gravity current",
      .measures =
          "The front of a cubic metre of viscous fluid that spreads over a floor in all directions, from 16 to 63 s, "
          "its largest difference from Huppert's similarity solution, with and without the corrected divergence; a "
          "quarter of it between symmetry planes.",
      .good = "Within 3 %, as the plane current; here the layer is but two rows deep at the end.",
      .good_errors = {0.03},
      .error_label = "front: largest |radius / exact - 1|",
      .resolution_label = "particles a metre",
      .profile_x = "time [s]",
      .profile_y = "radius of the front [m]",
      .methods = {"corrected divergence", "plain"},
      .quick = {10, 14, 20},
      .full = {14, 20, 28, 36},
      .run = [](std::size_t method, double per_metre) {
        return run_axisymmetric_current(choices_of(method, per_metre, 14.0));
      }};
}

Case make_benchmark_case() {
  return {
      .name = "lava_benchmark_1",
      .title = "Lava benchmark 1: viscous dam break",
      .measures =
          "The front of lava that is let go behind a dam on a flat floor, from 100 to 550 s, its largest difference "
          "from the benchmark's lubrication theory [Cordonnier 2015], with and without the corrected divergence.",
      .good = "Within 4 %: what is left of inertia is worth 1.6 %.",
      .good_errors = {0.04},
      .error_label = "front: largest |position / benchmark - 1|",
      .resolution_label = "particles a metre",
      .profile_x = "time [s]",
      .profile_y = "front [m]",
      .methods = {"corrected divergence", "plain"},
      .quick = {5, 6, 7.5},
      .full = {6, 7.5, 10, 14},
      .run = [](std::size_t method, double per_metre) {
        return run_viscous_dam_break(choices_of(method, per_metre, 20.0));
      }};
}

}  // namespace smelt::gravity_current
