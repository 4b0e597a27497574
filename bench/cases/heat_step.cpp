#include "bench/cases/heat_step.h"

#include "bench/cases/cpu_clock.h"
#include "bench/cases/norms.h"
#include "bench/cases/set_up.h"

#include <cmath>
#include <utility>

namespace smelt::heat_step {

namespace {

constexpr double density = 1000.0, case_time = 0.2;

/// Of each method: h over the spacing is 1.2 at every resolution, or grows as spacing^-0.3 from 1.3 at 20 particles a
/// metre.
double h_over_spacing(std::size_t method, double across) {
  return method == 0 ? 1.2 : 1.3 * std::pow(across / 20.0, 0.3);
}

/// The root mean square over four lattices, as one alone is more or less lucky; the profile is the last one's.
Measurement run_case(std::size_t method, double across) {
  constexpr int n_lattices = 4;
  Measurement measured;
  double squares = 0.0;
  for (int seed = 0; seed < n_lattices; ++seed) {
    const CpuClock clock;
    Solver<2, double> solver = make_strip(1.0 / across, h_over_spacing(method, across), 0.1, seed);
    solver.prepare();
    advance_by(solver, case_time);
    measured.cpu_seconds += clock.seconds() / n_lattices;
    const double error = l2_error(solver, case_time);
    squares += error * error / n_lattices;
    const auto& p = solver.particles();
    measured.n_particles = p.size();
    measured.profile.emplace();
    for (std::size_t i = 0; i < p.size(); i += 1 + p.size() / 400)
      measured.profile->computed.add(p.position[i][0], p.temperature[i] - cold);
  }
  for (double x = -1.0; x <= 1.0; x += 0.02) measured.profile->reference.add(x, exact(x, case_time));
  measured.error = std::sqrt(squares);
  return measured;
}

}  // namespace

double start_temperature(const Vec<2>& x) {
  return x[0] < 0.0 ? cold + 1.0 : cold;
}

Solver<2, double> make_strip(double spacing, double h_over_spacing, double jitter, int seed) {
  Particles<2> p = make_block<2>({Vec<2>(-1.0, 0.0), Vec<2>(1.0, width)}, spacing, density);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto site = static_cast<std::int64_t>(i);
    p.position[i] += jitter * spacing * Vec<2>(site_noise(site, seed, 0, 0), site_noise(site, seed, 0, 1));
  }
  for (const auto& x : p.position) p.temperature.push_back(start_temperature(x));
  auto parameters = make_parameters<2>(spacing, 1.0);
  parameters.smoothing_length = h_over_spacing * spacing;
  parameters.period = {Vec<2>(0.0, 0.0), Vec<2>(0.0, width)};
  Material m = inviscid_material(density);
  m.heat = HeatProperties{diffusivity, cold, cold + 1.0};
  return {parameters, {m}, {}, std::move(p)};
}

double exact(double x, double time) {
  return 0.5 * std::erfc(x / (2.0 * std::sqrt(diffusivity * time)));
}

double l2_error(const Solver<2, double>& solver, double time) {
  std::vector<double> differences;
  const auto& p = solver.particles();
  for (std::size_t i = 0; i < p.size(); ++i)
    if (std::abs(p.position[i][0]) < 0.95)
      differences.push_back(p.temperature[i] - cold - exact(p.position[i][0], time));
  return compute_norms(differences).l2;
}

Case make_case() {
  return {
      .name = "heat_step",
      .title = "Heat: a step that spreads",
      .measures =
          "The temperature 0.2 s after a step of one kelvin on a jittered lattice, diffusivity 0.1 m^2/s, against the "
          "error function: root mean square over four lattices.",
      .good = "Within 0.1 % of the step; where the number of neighbours grows too it converges faster.",
      .good_errors = {0.001},
      .error_label = "temperature: L2 error / step",
      .resolution_label = "particles a metre",
      .profile_x = "x [m]",
      .profile_y = "temperature above the cold side [K]",
      .methods = {"h = 1.2 spacings", "h as spacing^0.7"},
      .quick = {20, 40, 80},
      .full = {20, 40, 80, 160},
      .run = run_case};
}

}  // namespace smelt::heat_step
