#include "bench/cases/dam_break.h"

#include "bench/cases/cpu_clock.h"
#include "bench/cases/draw.h"
#include "bench/cases/tank.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace smelt::dam_break {

namespace {

constexpr double a = 0.146;   // [m]
constexpr double last = 3.4;  // T up to which fronts are compared

Measurement run_case(std::size_t method, double n_across) {
  const Reference experiment = read_reference(fmt::format("dam_break_{}", experiments[method]));
  const CpuClock clock;
  const Collapse run = collapse(static_cast<int>(n_across));
  const double seconds = clock.seconds(), origin = fit_origin(run.front, experiment);
  Measurement measured{.error = compare(run.front, experiment, origin).max,
                       .cpu_seconds = seconds,
                       .n_particles = run.particles.size(),
                       .profile = Profile()};
  for (double t = 0.0; t <= last; t += 0.1) measured.profile->computed.add(t, front_at(run.front, t - origin));
  for (std::size_t k = 0; k < experiment.column[0].size(); ++k)
    if (experiment.column[0][k] <= last)
      measured.profile->reference.add(experiment.column[0][k], experiment.column[1][k]);
  measured.picture = draw_speeds(run.particles, "The column at T = 3.4.", a, "/ a");
  return measured;
}

}  // namespace

Collapse collapse(int n_across) {
  const double spacing = a / n_across, floor_length = 12.0 * a;
  auto parameters = make_water_parameters(spacing, 2.0 * a, 0.05);
  parameters.equation_of_state.law = PressureLaw::tait;
  Particles<2> column = make_block<2>({Vec<2>(0.0, 0.0), Vec<2>(a, 2.0 * a)}, spacing, water_density);
  for (std::size_t i = 0; i < column.size(); ++i)
    column.density[i] = density_at_pressure(PressureLaw::tait, parameters.sound_speed,
                                            water_density * gravity * (2.0 * a - column.position[i][1]));
  Colliders<2> tank = make_colliders({{Vec<2>(floor_length, 0.0), Vec<2>(0.0, 0.0), Vec<2>(0.0, 4.0 * a)}});
  Solver<2, double> solver(parameters, {inviscid_material(water_density)}, std::move(tank), std::move(column));
  solver.prepare();
  Collapse seen{{"T,x/a", {{}, {}}}, {}};
  const double unit = std::sqrt(a / (2.0 * gravity)), interval = 0.02;
  for (int k = 0; k * interval < last + interval; ++k) {
    double front = 0.0;
    for (const Vec<2>& x : solver.particles().position) front = std::max(front, x[0]);
    seen.front.column[0].push_back(k * interval);
    seen.front.column[1].push_back((front + 0.5 * spacing) / a);
    advance_by(solver, interval * unit, k * interval * unit);
  }
  seen.particles = solver.particles();
  return seen;
}

double front_at(const Reference& run, double t) {
  return t <= 0.0 ? 1.0 : run.at(t);
}

Norms compare(const Reference& run, const Reference& experiment, double origin) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < experiment.column[0].size(); ++i) {
    const double t = experiment.column[0][i];
    if (t <= last) differences.push_back(front_at(run, t - origin) / experiment.column[1][i] - 1.0);
  }
  return compute_norms(differences);
}

double fit_origin(const Reference& run, const Reference& experiment) {
  double best = 0.0, least = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= 60; ++k) {
    const double l2 = compare(run, experiment, 0.01 * k).l2;
    if (l2 < least) best = 0.01 * k, least = l2;
  }
  return best;
}

Case make_case() {
  return {.name = "dam_break",
          .title = "Dam break",
          .measures =
              "The front of a water column a x 2a that collapses along a dry floor until T = t sqrt(2g/a) = 3.4, its "
              "largest difference from measured fronts, with the origin of time of each experiment fitted.",
          .good = "Within 10 %: the experiments differ from each other by more.",
          .good_errors = {0.1},
          .error_label = "front: largest |position / experiment - 1|",
          .resolution_label = "particles across a",
          .profile_x = "T = t sqrt(2g/a)",
          .profile_y = "front / a",
          .methods = {"Koshizuka & Oka 1996", "Martin & Moyce 1952, a = 1.125 in", "Martin & Moyce 1952, a = 2.25 in"},
          .quick = {10, 20, 30},
          .full = {10, 20, 40, 60, 80},
          .run = run_case};
}

}  // namespace smelt::dam_break
