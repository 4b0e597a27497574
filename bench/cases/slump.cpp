#include "bench/cases/slump.h"

#include "bench/cases/cpu_clock.h"
#include "bench/cases/reference.h"
#include "bench/cases/set_up.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace smelt::slump {

namespace {

constexpr double height = 0.3, gravity = 9.81, density = 1000.0;

/// A sheet of two triangles at y = 0 that no particle gets past the edge of; no slip.
Colliders<3> make_floor() {
  Obstacle<3> floor;
  floor.facets = {{Vec3(-9, 0, -9), Vec3(-9, 0, 9), Vec3(9, 0, 9)}, {Vec3(-9, 0, -9), Vec3(9, 0, 9), Vec3(9, 0, -9)}};
  floor.wall = true;
  Colliders<3> colliders;
  colliders.add(std::move(floor));
  return colliders;
}

constexpr std::array relative_yields{0.1, 0.2, 0.3};

/// The slice through the axis.
Picture draw(const Particles<3>& p, double spacing) {
  Picture picture{.caption = "A slice through the axis at rest.",
                  .x_label = "x [m]",
                  .y_label = "y [m]",
                  .value_label = "distance from the axis [m]"};
  for (const Vec3& x : p.position) {
    if (std::abs(x[2]) > spacing) continue;
    picture.x.push_back(x[0]);
    picture.y.push_back(x[1]);
    picture.value.push_back(std::hypot(x[0], x[2]));
  }
  return picture;
}

Measurement run_case(std::size_t method, double n) {
  const double expected = read_reference("bingham_slump_cylinder").at(relative_yields[method]);
  const CpuClock clock;
  const Slumped slumped = simulate_slump(relative_yields[method], static_cast<int>(n));
  return {.error = std::abs(slumped.slump / expected - 1.0),
          .cpu_seconds = clock.seconds(),
          .n_particles = slumped.particles.size(),
          .picture = draw(slumped.particles, height / n)};
}

}  // namespace

Slumped simulate_slump(double relative_yield, int n) {
  const double spacing = height / n, sound_speed = 10.0 * std::sqrt(2.0 * gravity * height);
  Box<3> box;
  box.lower = Vec3(-0.5 * height, 0.0, -0.5 * height);
  box.upper = Vec3(0.5 * height, height, 0.5 * height);
  Particles<3> particles =
      make_lattice<3>(box, spacing, density, 0.0, [](const Vec3& x) { return std::hypot(x[0], x[2]) <= 0.5 * height; });
  auto parameters = make_parameters<3>(spacing, sound_speed);
  parameters.gravity = Vec3(0.0, -gravity, 0.0);
  parameters.shear_wave_speed = sound_speed;
  parameters.artificial_viscosity = 0.2;
  parameters.hourglass_control = 1.0;
  parameters.courant = 0.4;
  const Material clay = viscoplastic_material(density, relative_yield * density * gravity * height, 60.0, 1.0, 1e4);
  Solver<3, float> solver(parameters, {clay}, make_floor(), std::move(particles));
  solver.prepare();
  advance_by(solver, 3.0);
  double top = 0.0;
  for (const Vec3& x : solver.particles().position) top = std::max(top, x[1] + 0.5 * spacing);
  return {1.0 - top / height, solver.particles()};
}

Case make_case() {
  return {
      .name = "slump",
      .title = "Slump of a Bingham cylinder",
      .measures =
          "How far a cylinder of clay as wide as tall has sunk after three seconds, against the formula of Pashias et "
          "al. (1996), for three yield stresses.",
      .good = "Within 10 %, as good as the formula itself.",
      .good_errors = {0.1},
      .error_label = "|slump / formula - 1|",
      .resolution_label = "particles high",
      .methods = {"yield stress 0.1 rho g H", "0.2 rho g H", "0.3 rho g H"},
      .quick = {8, 10, 12},
      .full = {8, 12, 16, 20},
      .run = run_case};
}

}  // namespace smelt::slump
