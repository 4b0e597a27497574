#include "bench/cases/rigid_rotation.h"

#include "bench/cases/cpu_clock.h"

#include <cmath>
#include <numbers>

namespace smelt::rigid_rotation {

namespace {

/// What a whole turn costs of the angular velocity.
template <int Dim>
Measurement turn(double n) {
  const double radius = n * spacing;
  const CpuClock clock;
  Solver<Dim, double> solver = make_spinning<Dim>(make_ball<Dim>(radius, spacing, density), radius);
  solver.prepare();
  const double before = angular_velocity<Dim>(solver);
  advance_by(solver, 2.0 * std::numbers::pi / rate_of(radius));
  return {.error = std::abs(angular_velocity<Dim>(solver) / before - 1.0),
          .cpu_seconds = clock.seconds(),
          .n_particles = solver.particles().size()};
}

}  // namespace

Case make_case() {
  return {.name = "rigid_rotation",
          .title = "A free body that spins",
          .measures =
              "What a stiff disc and a stiff ball (jump number 1000) lose of their angular velocity in one turn; they "
              "should keep all of it.",
          .good = "Within 1 %.",
          .good_errors = {0.01},
          .error_label = "|angular velocity / start - 1|",
          .resolution_label = "particles in the radius",
          .methods = {"disc", "ball"},
          .quick = {3, 4, 6},
          .full = {4, 6, 8, 10},
          .run = [](std::size_t method, double n) { return method == 0 ? turn<2>(n) : turn<3>(n); }};
}

}  // namespace smelt::rigid_rotation
