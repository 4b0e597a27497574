// Steady plane channel flow of a viscoplastic fluid [P 6-1] between two walls, with the relaxed stress: profile and
// plug.

#include "core/sph/stress_update.h"
#include "tests/accuracy/measure.h"
#include "tests/accuracy/set_up.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace smelt {
namespace {

constexpr double yield_stress = 1.0,
                 body_force = 2.0;  // and half width, density, consistency 1: the walls bear two yield stresses

/// A channel -1 < y < 1 eight spacings long that repeats.
Solver<2, double> make_channel(int across, double jump) {
  const double spacing = 2.0 / across, wave_speed = 40.0;
  auto parameters = make_parameters<2>(spacing, wave_speed);
  parameters.smoothing_length = 1.3 * spacing;
  parameters.gravity = Vec<2>(body_force, 0.0);
  parameters.courant = 0.4;
  parameters.shear_wave_speed = wave_speed;
  parameters.hourglass_control = 1.0;
  parameters.period.lower = Vec<2>(0.0, 0.0);
  parameters.period.upper = Vec<2>(8.0 * spacing, 0.0);
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

struct Measured {
  double velocity;  // L2 of the differences over L2 of the velocity
  double plug;      // half width of what is below the yield stress
};

Measured measure(const Particles<2>& p, const Reference& reference, int across) {
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

/// From rest: steady after 4 s. By 8 s the rows at the walls have slid eight spacings past each other; what that
/// disorder costs has a row and no bar.
void report_channel(int jump) {
  constexpr int across = 40;
  const Reference reference = read_reference(fmt::format("smd_channel_J{}", jump));
  Solver<2, double> solver = make_channel(across, jump);
  solver.prepare();
  advance_by(solver, 4.0);
  const Measured steady = measure(solver.particles(), reference, across);
  advance_by(solver, 4.0, 4.0);
  const Measured later = measure(solver.particles(), reference, across);
  const std::string problem = fmt::format("viscoplastic channel; J = {}", jump),
                    resolution = fmt::format("{} across", across);
  report_row({.problem = problem,
              .quantity = "velocity L2 / L2 of the velocity",
              .resolution = resolution,
              .error = steady.velocity,
              .bar = 0.02});
  report_row({.problem = problem,
              .quantity = "the same after twice the time",
              .resolution = resolution,
              .error = later.velocity});
  report_row({.problem = problem,
              .quantity = "half width of the plug - exact / spacing",
              .resolution = resolution,
              .error = std::abs(steady.plug - 0.5) * across / 2.0,
              .bar = 1.0});
}

TEST(SmdChannel, J15) {
  report_channel(15);
}
TEST(SmdChannel, J150) {
  report_channel(150);
}
TEST(SmdChannel, J1500) {
  report_channel(1500);
}

}  // namespace
}  // namespace smelt
