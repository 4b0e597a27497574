#include "bench/cases/poiseuille.h"

#include "bench/cases/cpu_clock.h"
#include "bench/cases/norms.h"
#include "bench/cases/reference.h"
#include "bench/cases/set_up.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace smelt::poiseuille {

namespace {

constexpr double width = 1e-3, kinematic_viscosity = 1e-6, density = 1000.0, body_force = 1e-4;
constexpr double peak = body_force * width * width / (8.0 * kinematic_viscosity);  // of the steady velocity [m/s]

/// A channel that repeats, between the two planes: eight spacings long, ten for the quintic spline, which reaches
/// farther.
Solver<2, double> make_channel(int across, const Setting& setting) {
  const double spacing = width / across;
  auto parameters = make_parameters<2>(spacing, 10.0 * peak);
  parameters.kernel = setting.kernel;
  parameters.smoothing_length = 1.3 * spacing;
  parameters.gravity = Vec<2>(body_force, 0.0);
  parameters.courant = 0.4;
  parameters.hourglass_control = setting.hourglass_control;
  parameters.period.lower = Vec<2>(0.0, 0.0);
  const double length = (setting.kernel == KernelType::quintic_spline ? 10.0 : 8.0) * spacing;
  parameters.period.upper = Vec<2>(length, 0.0);
  Obstacle<2> planes{
      {{Vec<2>(2.0 * width, 0.0), Vec<2>(-width, 0.0)}, {Vec<2>(-width, width), Vec<2>(2.0 * width, width)}}};
  planes.wall = setting.wall;
  Colliders<2> colliders;
  colliders.add(std::move(planes));
  const Box<2> channel{Vec<2>(0.0, 0.0), Vec<2>(length, width)};
  return {parameters,
          {newtonian_material(density, density * kinematic_viscosity)},
          std::move(colliders),
          make_block<2>(channel, spacing, density, setting.jitter)};
}

/// sqrt(sum e^2 / sum u^2) over the particles, e what a velocity along the channel is off from column `c` of the
/// reference.
double relative_error(const Particles<2>& p, const Reference& reference, std::size_t c) {
  std::vector<double> differences, exact;
  for (std::size_t i = 0; i < p.size(); ++i) {
    exact.push_back(reference.at(p.position[i][1], c));
    differences.push_back(p.velocity[i][0] - exact.back());
  }
  return compute_norms(differences).l2 / compute_norms(exact).l2;
}

/// Runs through the times; errors[k] is the one at times[k]. Returns the particles at the last.
Particles<2> run_through(int across, const Setting& setting, const Reference& reference,
                         std::array<double, times.size()>& errors) {
  Solver<2, double> solver = make_channel(across, setting);
  solver.prepare();
  double time = 0.0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    advance_by(solver, times[k] - time, time);
    time = times[k];
    errors[k] = relative_error(solver.particles(), reference, k + 1);
  }
  return solver.particles();
}

const std::array<Setting, 3> methods{{{}, {.kernel = KernelType::quintic_spline}, {.jitter = 0.2}}};

Measurement run_case(std::size_t method, double across) {
  const Reference reference = read_reference("poiseuille_startup");
  std::array<double, times.size()> errors{};
  const CpuClock clock;
  const Particles<2> p = run_through(static_cast<int>(across), methods[method], reference, errors);
  Measurement measured{.error = *std::max_element(errors.begin(), errors.end()),
                       .cpu_seconds = clock.seconds(),
                       .n_particles = p.size()};
  measured.profile.emplace();
  measured.profile->reference = {reference.column[0], reference.column[times.size()]};
  for (std::size_t i = 0; i < p.size(); ++i) measured.profile->computed.add(p.position[i][1], p.velocity[i][0]);
  return measured;
}

}  // namespace

std::array<double, times.size()> run_channel(int across, const Setting& setting) {
  std::array<double, times.size()> errors{};
  run_through(across, setting, read_reference("poiseuille_startup"), errors);
  return errors;
}

Case make_case() {
  return {.name = "poiseuille",
          .title = "Start-up of plane Poiseuille flow",
          .measures =
              "The velocity between two planes as a Newtonian fluid is set in motion by a body force [Morris 1997], at "
              "five times from start to steady flow, the worst of them, against the series.",
          .good = "Within 1 % on a regular lattice; a jittered one costs up to 2.5 %.",
          .good_errors = {0.01, 0.01, 0.025},
          .error_label = "velocity: L2 error / L2",
          .resolution_label = "particles across the channel",
          .profile_x = "height [m]",
          .profile_y = "velocity [m/s] after 1 s",
          .methods = {"cubic spline", "quintic spline", "cubic spline, jittered lattice"},
          .quick = {10, 20, 40},
          .full = {10, 20, 40, 80},
          .run = run_case};
}

}  // namespace smelt::poiseuille
