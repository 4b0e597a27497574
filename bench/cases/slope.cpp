#include "bench/cases/slope.h"

#include "bench/cases/cpu_clock.h"
#include "bench/cases/set_up.h"
#include "core/error.h"
#include "core/sph/rheology.h"

#include <array>
#include <cmath>
#include <utility>

namespace smelt::slope {

namespace {

// The slope is given to gravity and not to the bed.
constexpr double along = 0.5, wave_speed = 20.0;
constexpr double flow_rate = 1.0;  // yield stress over consistency
constexpr double jump = 1e5;
const double across = std::sqrt(1.0 - along * along);

/// Nearly a Bingham fluid, of which a layer of thickness 1 is `ratio` times as thick as the critical one.
Material make_material(double ratio) {
  const double yield_stress = along / ratio;
  return viscoplastic_material(1.0, yield_stress, yield_stress / flow_rate, 1.0, jump);
}

/// A layer eight spacings long that repeats, on a wall, its pressure and shear stress those that gravity asks for.
Solver<2, double> make_layer(int n_rows, double ratio, double h_over_spacing) {
  const double spacing = 1.0 / n_rows;
  auto parameters = make_parameters<2>(spacing, wave_speed);
  parameters.smoothing_length = h_over_spacing * spacing;
  parameters.gravity = Vec<2>(along, -across);
  parameters.courant = 0.4;
  parameters.shear_wave_speed = wave_speed;
  parameters.hourglass_control = 1.0;
  parameters.density_diffusion = 0.1;
  parameters.period.lower = Vec<2>(0.0, 0.0);
  parameters.period.upper = Vec<2>(8.0 * spacing, 0.0);
  Obstacle<2> bed{{{Vec<2>(2.0, 0.0), Vec<2>(-1.0, 0.0)}}};
  bed.wall = true;
  Colliders<2> colliders;
  colliders.add(std::move(bed));
  Particles<2> p = make_block<2>({Vec<2>(0.0, 0.0), Vec<2>(8.0 * spacing, 1.0)}, spacing, 1.0);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double depth = 1.0 - p.position[i][1];
    p.density[i] += across * depth / (wave_speed * wave_speed);
    p.stress.push_back(Symmetric<2>(0.0, 0.0, along * depth));
    p.viscosity.push_back(0.0F);
  }
  return {parameters, {make_material(ratio)}, std::move(colliders), std::move(p)};
}

/// Of the top row of particles.
double surface_speed(const Particles<2>& p, int n_rows) {
  double sum = 0.0;
  int n = 0;
  for (std::size_t i = 0; i < p.size(); ++i)
    if (p.position[i][1] > 1.0 - 1.0 / n_rows) sum += p.velocity[i][0], ++n;
  CHECK_EQ(n, 8);
  return sum / n;
}

constexpr std::array ratios{1.05, 1.5};

Measurement run_case(std::size_t method, double n) {
  const double ratio = ratios[method], exact = exact_speed(ratio);
  const int n_rows = static_cast<int>(n);
  const CpuClock clock;
  const double speed = run_layer(n_rows, ratio, method == 0 ? 3.0 : 5.0);
  return {.error = std::abs(speed / exact - 1.0),
          .cpu_seconds = clock.seconds(),
          .n_particles = static_cast<std::size_t>(8 * n_rows)};
}

}  // namespace

double exact_speed(double ratio) {
  const FlowCurve curve = flow_curve_at(make_material(ratio).rheology, 0.0);
  constexpr int n = 20000;
  double speed = 0.0;
  for (int k = 0; k < n; ++k) {
    const double stress = along * (k + 0.5) / n;
    double low = 0.0, high = flow_rate * ratio;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = 0.5 * (low + high);
      (shear_stress(curve, middle) < stress ? low : high) = middle;
    }
    speed += low / n;
  }
  return speed;
}

double run_layer(int n_rows, double ratio, double end, double h_over_spacing) {
  Solver<2, double> solver = make_layer(n_rows, ratio, h_over_spacing);
  solver.prepare();
  double way = 0.0, time = 0.0;
  while (time < end) {
    const double dt = solver.step(end - time, time).dt;
    time += dt;
    if (time > end - 1.0) way += dt * surface_speed(solver.particles(), n_rows);
  }
  return way;
}

Case make_case() {
  return {
      .name = "slope",
      .title = "Viscoplastic layer on a slope",
      .measures =
          "The speed of the surface of a nearly Bingham layer just and well above the thickness at which it starts to "
          "flow, against the flow curve's integral.",
      .good =
          "Within 10 % just above the critical thickness, where a change of 1 % in thickness changes the speed by 40 "
          "%, and 2 % well above.",
      .good_errors = {0.1, 0.02},
      .error_label = "|speed of the surface / exact - 1|",
      .resolution_label = "rows of particles",
      .methods = {"1.05 of the critical thickness", "1.5 of the critical thickness"},
      .quick = {24, 32, 40},
      .full = {24, 32, 40, 60, 80},
      .run = run_case};
}

}  // namespace smelt::slope
