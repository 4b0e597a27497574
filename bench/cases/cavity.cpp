#include "bench/cases/cavity.h"

#include "bench/cases/cpu_clock.h"
#include "bench/cases/draw.h"
#include "bench/cases/set_up.h"
#include "core/sph/kernel.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace smelt::cavity {

namespace {

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

/// To 0.3 L/U, when the flow is steady.
Measurement run_case(std::size_t, double n) {
  const int across = static_cast<int>(n);
  const Reference reference = read_reference("cavity_re1_centrelines");
  const CpuClock clock;
  Solver<2, double> solver = make_cavity(across);
  solver.prepare();
  advance_by(solver, 0.3);
  Measurement measured{.cpu_seconds = clock.seconds(), .n_particles = solver.particles().size(), .profile = Profile()};
  const Errors errors = measure(solver, reference, across);
  measured.error = std::max(errors.u, errors.v);
  measured.profile->reference = {reference.column[0], reference.column[1]};
  for (int k = 1; k < 40; ++k) measured.profile->computed.add(k / 40.0, interpolate(solver, Vec<2>(0.5, k / 40.0))[0]);
  measured.picture =
      draw_speeds(solver.particles(), "Particles coloured by speed: the lid slides to the right.", 1.0, "/ side");
  return measured;
}

}  // namespace

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

Errors measure(const Solver<2, double>& solver, const Reference& reference, int across) {
  Errors largest;
  for (const double s : reference.column[0]) {
    if (std::min(s, 1.0 - s) < 1.0 / across) continue;
    largest.u = std::max(largest.u, std::abs(interpolate(solver, Vec<2>(0.5, s))[0] - reference.at(s, 1)));
    largest.v = std::max(largest.v, std::abs(interpolate(solver, Vec<2>(s, 0.5))[1] - reference.at(s, 2)));
  }
  return largest;
}

Case make_case() {
  return {
      .name = "cavity",
      .title = "Lid-driven cavity",
      .measures =
          "The steady flow in a square box whose lid slides, Re = 1: the largest difference of the velocities on the "
          "two middle lines from finite differences.",
      .good = "Within 2 % of the lid's speed.",
      .good_errors = {0.02},
      .error_label = "velocity: largest error / lid speed",
      .resolution_label = "particles along a side",
      .profile_x = "height on the middle line / side",
      .profile_y = "horizontal velocity / lid speed",
      .methods = {"cubic spline, h = 1.4 spacings"},
      .quick = {10, 20, 30, 40},
      .full = {20, 30, 40, 60, 80},
      .run = run_case};
}

}  // namespace smelt::cavity
