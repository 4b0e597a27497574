#include "bench/cases/smd_channel.h"

#include "bench/cases/cpu_clock.h"
#include "bench/cases/norms.h"
#include "bench/cases/set_up.h"
#include "core/error.h"
#include "core/sph/stress_update.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace smelt::smd_channel {

namespace {

constexpr double yield_stress = 1.0,
                 body_force = 2.0;  // and half width, density, consistency 1: the walls bear two yield stresses

/// Velocity at `y` from the centre, by the cubic that has the reference's velocities and shear rates (columns 1 and 2)
/// at the ends of its interval: a straight line between values 0.05 apart would be off by 0.7 % of the fastest.
double exact_velocity(const Reference& reference, double y) {
  const auto& at = reference.column[0];
  const auto upper =
      std::clamp<std::ptrdiff_t>(std::upper_bound(at.begin(), at.end(), y) - at.begin(), 1, std::ssize(at) - 1);
  const auto k = static_cast<std::size_t>(upper) - 1;
  const double length = at[k + 1] - at[k], s = (y - at[k]) / length;
  CHECK_LE(std::abs(s - 0.5), 0.5);
  const auto& u = reference.column[1];
  const auto& rate = reference.column[2];  // -du/dy
  return u[k] * (1.0 + 2.0 * s) * (1.0 - s) * (1.0 - s) + u[k + 1] * s * s * (3.0 - 2.0 * s) -
         length * s * (1.0 - s) * ((1.0 - s) * rate[k] - s * rate[k + 1]);
}

constexpr std::array jumps{15, 150, 1500};

Profile profile_of(const Particles<2>& p, const Reference& reference) {
  Profile profile;
  profile.reference = {reference.column[0], reference.column[1]};
  for (std::size_t i = 0; i < p.size(); ++i) profile.computed.add(std::abs(p.position[i][1]), p.velocity[i][0]);
  return profile;
}

Measurement run_case(std::size_t method, double across) {
  const int n = static_cast<int>(across);
  const Reference reference = read_profile(jumps[method]);
  const CpuClock clock;
  Solver<2, double> solver = make_channel(n, jumps[method]);
  solver.prepare();
  advance_by(solver, steady_time);
  const double seconds = clock.seconds();
  return {.error = measure(solver.particles(), reference, n).velocity,
          .cpu_seconds = seconds,
          .n_particles = solver.particles().size(),
          .profile = profile_of(solver.particles(), reference)};
}

}  // namespace

Reference read_profile(int jump) {
  return read_reference(fmt::format("smd_channel_J{}", jump));
}

Solver<2, double> make_channel(int across, double jump, const std::function<void(SolverParameters<2>&)>& tune) {
  const double spacing = 2.0 / across, wave_speed = 40.0;
  auto parameters = make_parameters<2>(spacing, wave_speed);
  parameters.smoothing_length = 1.3 * spacing;
  parameters.gravity = Vec<2>(body_force, 0.0);
  parameters.courant = 0.4;
  parameters.shear_wave_speed = wave_speed;
  parameters.hourglass_control = 1.0;
  parameters.period.lower = Vec<2>(0.0, 0.0);
  parameters.period.upper = Vec<2>(8.0 * spacing, 0.0);
  if (tune) tune(parameters);
  Obstacle<2> planes{{{Vec<2>(4.0, -1.0), Vec<2>(-2.0, -1.0)}, {Vec<2>(-2.0, 1.0), Vec<2>(4.0, 1.0)}}};
  planes.wall = true;
  Colliders<2> colliders;
  colliders.add(std::move(planes));
  const Box<2> channel{Vec<2>(0.0, -1.0), Vec<2>(8.0 * spacing, 1.0)};
  return {parameters,
          {viscoplastic_material(1.0, yield_stress, 1.0, 0.5, jump)},
          std::move(colliders),
          make_block<2>(channel, spacing, 1.0)};
}

Errors measure(const Particles<2>& p, const Reference& reference, int across) {
  std::vector<double> differences, exact;
  double plug = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double y = std::abs(p.position[i][1]);
    exact.push_back(exact_velocity(reference, y));
    differences.push_back(p.velocity[i][0] - exact.back());
    if (stress_magnitude<2>(p.stress[i]) <= yield_stress) plug = std::max(plug, y + 1.0 / across);
  }
  return {compute_norms(differences).l2 / compute_norms(exact).l2, plug};
}

Case make_case() {
  return {
      .name = "channel",
      .title = "Viscoplastic channel",
      .measures =
          "The velocity across a plane channel of the Souza Mendes-Dutra fluid whose walls bear two yield stresses, "
          "from rest until it is steady, against quadrature, for three jump numbers.",
      .good = "Within 2 %: the plug is then as wide as it should be to a fraction of a spacing.",
      .good_errors = {0.02},
      .error_label = "velocity: L2 error / L2",
      .resolution_label = "particles across the channel",
      .profile_x = "distance from the middle / half width",
      .profile_y = "velocity [-]",
      .methods = {"J = 15", "J = 150", "J = 1500"},
      .quick = {10, 20, 40, 60},
      .full = {20, 40, 60, 80, 120},
      .run = run_case};
}

}  // namespace smelt::smd_channel
