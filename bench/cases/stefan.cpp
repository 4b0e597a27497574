#include "bench/cases/stefan.h"

#include "bench/cases/cpu_clock.h"
#include "bench/cases/reference.h"
#include "bench/cases/tank.h"
#include "core/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace smelt::stefan {

namespace {

constexpr double diffusivity = 1.0, density = 1000.0, melting = 300.0, hotter = 1.0;

/// A column 1 m high on a wall that is one kelvin hotter, six particles wide and repeating sideways; nothing moves.
Solver<2, double> make_column(double spacing, double stefan_number, double jitter) {
  const double width = 6.0 * spacing;
  Box<2> box;
  box.lower = Vec<2>::Zero();
  box.upper = Vec<2>(width, 1.0);
  Particles<2> p = make_block<2>(box, spacing, density, jitter);
  p.temperature.assign(p.size(), melting);
  auto parameters = make_parameters<2>(spacing, 1e-3);
  parameters.period.lower = Vec<2>(0.0, 0.0);
  parameters.period.upper = Vec<2>(width, -1.0);
  Material m = inviscid_material(density);
  m.heat = HeatProperties{diffusivity, melting, melting};
  m.heat->specific_heat = 1.0;
  m.heat->latent_heat = hotter / stefan_number;
  Obstacle<2> floor = make_wall({Vec<2>(-1.0, 0.0), Vec<2>(1.0 + width, 0.0)});
  std::swap(floor.facets[0][0], floor.facets[0][1]);
  floor.temperature = melting + hotter;
  Colliders<2> colliders;
  colliders.add(std::move(floor));
  return {parameters, {m}, std::move(colliders), std::move(p)};
}

/// Height at which the melted fraction, averaged over rows, crosses one half [m].
double front_of(const Solver<2, double>& solver, double spacing) {
  std::map<long, std::pair<double, int>> rows;
  for (std::size_t i = 0; i < solver.particles().size(); ++i) {
    auto& [sum, n] = rows[std::lround(std::floor(solver.particles().position[i][1] / spacing))];
    sum += solver.melted_fraction_of(i);
    ++n;
  }
  double below = 1.0, height = 0.0;
  for (const auto& [row, value] : rows) {
    const double y = (static_cast<double>(row) + 0.5) * spacing;
    const double melted = value.first / value.second;
    if (melted < 0.5) return height + (below - 0.5) / (below - melted) * (y - height);
    below = melted;
    height = y;
  }
  return 1.0;
}

constexpr std::array stefan_numbers{0.1, 0.5, 2.0};

Measurement run_case(std::size_t method, double across) {
  const double stefan_number = stefan_numbers[method];
  return measure_front(1.0 / across, stefan_number, 0.0, farthest_front(stefan_number));
}

}  // namespace

Measurement measure_front(double spacing, double stefan_number, double jitter, double farthest) {
  const Reference reference = read_reference(fmt::format("stefan_front_Ste{:.1f}", stefan_number));
  const CpuClock clock;
  Solver<2, double> solver = make_column(spacing, stefan_number, jitter);
  solver.prepare();
  Measurement measured{.n_particles = solver.particles().size(), .profile = Profile()};
  double time = 0.0;
  for (std::size_t k = 0; k < reference.column[0].size(); ++k) {
    const double exact = reference.column[1][k];
    if (exact < 0.25 || exact > farthest) continue;
    advance_by(solver, reference.column[0][k] - time, time);
    time = reference.column[0][k];
    const double front = front_of(solver, spacing);
    measured.error = std::max(measured.error, std::abs(front / exact - 1.0));
    measured.profile->computed.add(time, front);
    measured.profile->reference.add(time, exact);
  }
  CHECK_GT(measured.profile->computed.x.size(), 1u);
  measured.cpu_seconds = clock.seconds();
  return measured;
}

double farthest_front(double stefan_number) {
  return stefan_number < 0.2 ? 0.4 : 0.65;
}

Case make_case() {
  return {.name = "stefan",
          .title = "Stefan: a melting front",
          .measures =
              "How far a solid at its melting point has melted from a hot wall, the worst over the times at which a "
              "quarter to two thirds of it is liquid, against Neumann's similarity solution, for three Stefan numbers "
              "(sensible over latent heat).",
          .good = "Within 2 % of the front's height: a row of particles melts at a time.",
          .good_errors = {0.02},
          .error_label = "front: largest |height / exact - 1|",
          .resolution_label = "particles in the column",
          .profile_x = "time [s]",
          .profile_y = "height of the front [m]",
          .methods = {"Ste = 0.1", "Ste = 0.5", "Ste = 2"},
          .quick = {10, 20, 40, 80},
          .full = {10, 20, 40, 80, 160},
          .run = run_case};
}

}  // namespace smelt::stefan
