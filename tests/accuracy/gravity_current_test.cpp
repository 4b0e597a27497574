// Viscous gravity currents along a flat floor, 2D: the plane current of [Huppert 1982] and the viscous dam break of the
// lava benchmarks, both against lubrication theory.

#include "bench/cases/gravity_current.h"

#include "bench/cases/set_up.h"
#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace smelt {
namespace {

using namespace gravity_current;

TEST(GravityCurrent, PlaneFrontIsHupperts) {
  const std::string problem = "plane gravity current; 32 to 316 s";
  const std::vector<double> spacings = full_run() ? std::vector<double>{0.05, 0.035} : std::vector<double>{0.05};
  std::vector<double> errors;
  for (const double spacing : spacings) errors.push_back(run_plane_current({spacing, 14.0}).error);
  for (std::size_t i = 0; i < errors.size(); ++i)
    report_row({.problem = problem,
                .quantity = "front position relative; max",
                .resolution = fmt::format("spacing {} m", spacings[i]),
                .error = errors[i],
                .bar = 0.03,
                .order = i > 0 ? std::optional(convergence_order(spacings, errors)) : std::nullopt});
}

TEST(GravityCurrent, ViscousDamBreakIsLavaBenchmark1) {
  // At 0.1333 m, 8 rows where it starts and 3 at the end, the front is 7.5 % too far.
  const std::string problem = "lava benchmark 1: viscous dam break; 100 to 550 s";
  const std::vector<double> spacings = full_run() ? std::vector<double>{0.1333, 0.1} : std::vector<double>{0.1};
  std::vector<double> errors;
  for (const double spacing : spacings) errors.push_back(run_viscous_dam_break({spacing, 20.0}).error);
  for (std::size_t i = 0; i < errors.size(); ++i)
    report_row({.problem = problem,
                .quantity = "front position relative; max",
                .resolution = fmt::format("spacing {} m", spacings[i]),
                .error = errors[i],
                .bar = spacings[i] > 0.1 ? std::nullopt : std::optional(0.04),
                .order = i > 0 ? std::optional(convergence_order(spacings, errors)) : std::nullopt});
}

// ------------------------------------------------------------------------------------------------------ a thin layer

/// How far the top row of a jittered layer of `n_rows`, 0.5 m deep, has sunk after 10 s down a slope of 0.4 on which
/// nothing slips, 1 m/s fast at its surface, in its height.
double sink(int n_rows) {
  constexpr double deep = 0.5, density = 1000.0, sound_speed = 40.0;
  const double spacing = deep / n_rows, slope = std::atan(0.4);
  auto parameters = make_parameters<2>(spacing, sound_speed);
  parameters.smoothing_length = 1.3 * spacing;
  parameters.gravity = 9.81 * Vec<2>(std::sin(slope), -std::cos(slope));
  parameters.courant = 0.4;
  parameters.shear_wave_speed = sound_speed;
  parameters.hourglass_control = 1.0;
  parameters.density_diffusion = 0.1;
  parameters.corrected_divergence = true;
  parameters.period = {Vec<2>::Zero(), Vec<2>(8.0 * spacing, 0.0)};
  Colliders<2> bed;
  bed.add(make_plane(Vec<2>(9.0, 0.0), Vec<2>(-3.0, 0.0), 0.0));
  Particles<2> layer = make_block<2>({Vec<2>::Zero(), Vec<2>(8.0 * spacing, deep)}, spacing, density, 0.1);
  const double viscosity = 0.5 * density * parameters.gravity[0] * deep * deep;
  Solver<2, double> solver(parameters, {newtonian_material(density, viscosity)}, std::move(bed), std::move(layer));
  solver.prepare();
  advance_by(solver, 10.0);
  std::vector<double> heights;
  for (const Vec<2>& x : solver.particles().position) heights.push_back(x[1]);
  std::sort(heights.begin(), heights.end());
  return 1.0 - std::accumulate(heights.end() - 8, heights.end(), 0.0) / 8.0 / (deep - 0.5 * spacing);
}

// Where the corrected divergence alone made the density, nothing noticed particles that crowd as they pass one another:
// layers sank by a quarter in 10 s (docs/decisions/0015-thin-flows.md).
TEST(GravityCurrent, LayersKeepTheirDepth) {
  for (const int n_rows : {4, 8})
    report_row({.problem = "viscous layer on a slope of 0.4; corrected divergence; 10 s",
                .quantity = "way down of the top row / its height",
                .resolution = fmt::format("{} rows", n_rows),
                .error = std::abs(sink(n_rows)),
                .bar = 0.16});
}

// ---------------------------------------------------------------------------------------------------- slip and no slip

/// How far a block of lava got down a slope [m].
struct Way {
  double middle, front;
};

/// 0.4 m long, 0.2 m high, let go on a slope of 20 degrees for 0.4 s; `friction` 1: it slips, 0: it does not  [P
/// figure 6.7].
Way slide(double friction) {
  constexpr double spacing = 0.02, length = 0.4, duration = 0.4, slope = 20.0 * std::numbers::pi / 180.0;
  auto parameters = make_parameters<2>(spacing, 20.0);
  parameters.gravity = 9.81 * Vec<2>(std::sin(slope), -std::cos(slope));
  parameters.courant = 0.4;
  parameters.shear_wave_speed = 20.0;
  parameters.hourglass_control = 1.0;
  parameters.corrected_divergence = true;
  Colliders<2> bed;
  bed.add(make_plane(Vec<2>(9.0, 0.0), Vec<2>(-3.0, 0.0), friction));
  Particles<2> block = make_block<2>({Vec<2>(0.0, 0.0), Vec<2>(length, 0.2)}, spacing, 2700.0);
  Solver<2, double> solver(parameters, {newtonian_material(2700.0, 1000.0)}, std::move(bed), std::move(block));
  solver.prepare();
  advance_by(solver, duration);
  double middle = 0.0;
  for (const Vec<2>& x : solver.particles().position) middle += x[0] / static_cast<double>(solver.particles().size());
  double front = 0.0;
  for (const Vec<2>& x : solver.particles().position) front = std::max(front, x[0]);
  return {middle - 0.5 * length, front + 0.5 * spacing - length};
}

// Without friction nothing but gravity pulls along the slope: the middle moves by g sin(slope) t^2/2, however the block
// deforms.
TEST(GravityCurrent, SlipsAsFrictionSays) {
  const Way slips = slide(1.0), sticks = slide(0.0);
  const double free_way = 0.5 * 9.81 * std::sin(20.0 * std::numbers::pi / 180.0) * 0.4 * 0.4;
  const std::string problem = "block of lava on a slope of 20 degrees; 0.4 s", resolution = "10 particles high";
  report_row({.problem = problem,
              .quantity = "way of the middle with slip / free fall along the slope - 1",
              .resolution = resolution,
              .error = std::abs(slips.middle / free_way - 1.0),
              .bar = 0.01});
  report_row({.problem = problem,
              .quantity = "way of the middle without slip / with",
              .resolution = resolution,
              .error = sticks.middle / slips.middle,
              .bar = 0.5});
  report_row({.problem = problem,
              .quantity = "way of the front without slip / with",
              .resolution = resolution,
              .error = sticks.front / slips.front,
              .bar = 0.7});
}

}  // namespace
}  // namespace smelt
