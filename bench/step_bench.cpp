#include "bench/step_bench.h"

#include "bench/cases/set_up.h"
#include "bench/in_child.h"
#include "bench/peak_memory.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

namespace smelt {

namespace {

constexpr double spacing = 0.01, density = 900.0, cold = 300.0, hot = 400.0;

Particles<3> make_heap(std::size_t n, bool with_heat) {
  const int high = std::max(2, static_cast<int>(std::lround(std::cbrt(static_cast<double>(n) / 4.0)))), wide = 2 * high;
  Box<3> box;
  box.lower = Vec3(-0.5 * wide * spacing, 0.0, -0.5 * wide * spacing);
  box.upper = Vec3(0.5 * wide * spacing, high * spacing, 0.5 * wide * spacing);
  Particles<3> heap = make_block<3>(box, spacing, density, 0.1);
  if (!with_heat) return heap;
  for (const Vec3& x : heap.position)
    heap.temperature.push_back(cold + (hot - cold) * std::min(1.0, 2.0 * x[1] / box.upper[1]));
  return heap;
}

Material make_wax(const StepBenchTerms& terms) {
  Material wax =
      terms.viscoplastic ? viscoplastic_material(density, 50.0, 20.0, 0.5, 100.0) : newtonian_material(density, 5.0);
  if (terms.heat) {
    wax.heat = HeatProperties{1e-5, cold, hot, 0.0, 0.0, 0.0};
    if (terms.viscoplastic) {
      wax.rheology.yield_stress = {500.0, 5.0};
      wax.rheology.jump_number = ThermalRange{150.0, 15.0};
    }
  }
  return wax;
}

Colliders<3> make_floor(double half) {
  Obstacle<3> floor;
  floor.wall = true;
  const Vec3 a(-half, 0.0, -half), b(-half, 0.0, half), c(half, 0.0, half), d(half, 0.0, -half);
  floor.facets = {{a, b, c}, {a, c, d}};
  Colliders<3> colliders;
  colliders.add(std::move(floor));
  return colliders;
}

double mean_neighbours(const Solver<3, float>& solver) {
  const auto& x = solver.particles().position;
  const double reach2 = std::pow(2.0 * solver.parameters().smoothing_length, 2);
  double n = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (const std::int32_t j : solver.neighbours().row(i))
      n += (x[i] - x[static_cast<std::size_t>(j)]).squaredNorm() < reach2;
  return n / static_cast<double>(x.size());
}

/// Shares of the stages in the time of the steps that `advance` makes.
template <typename Advance>
std::array<double, step_stage_names.size()> observe_stages(Solver<3, float>& solver, const Advance& advance) {
  std::array<double, step_stage_names.size()> shares{};
  auto last = std::chrono::steady_clock::now();
  solver.observe([&](StepStage stage) {
    const auto now = std::chrono::steady_clock::now();
    shares[static_cast<std::size_t>(stage)] += std::chrono::duration<double>(now - last).count();
    last = now;
  });
  advance();
  solver.observe(nullptr);
  const double whole = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (double& share : shares) share /= whole;
  return shares;
}

StepBenchResult time_steps(std::size_t n_particles, const StepBenchTerms& terms) {
  const double before = peak_memory();
  const double height = std::cbrt(static_cast<double>(n_particles) / 4.0) * spacing;
  auto parameters = make_parameters<3>(spacing, 10.0 * std::sqrt(2.0 * 9.81 * height));
  parameters.courant = 0.4;
  parameters.artificial_viscosity = 0.2;
  if (terms.viscoplastic) parameters.shear_wave_speed = parameters.sound_speed;
  if (terms.hourglass) parameters.hourglass_control = 1.0;
  if (terms.xsph) parameters.xsph = 0.3;
  if (terms.walls) parameters.gravity = Vec3(0.0, -9.81, 0.0);
  Solver<3, float> solver(parameters, {make_wax(terms)}, terms.walls ? make_floor(100.0 * height) : Colliders<3>(),
                          make_heap(n_particles, terms.heat));
  StepBenchResult result;
  result.n_particles = solver.particles().size();
  solver.prepare();
  double t = 0.0;
  // From search to search; what hardly moves is not waited for.
  const auto advance_past_searches = [&](std::size_t n) {
    const auto most_steps = static_cast<int>(40 * n);
    int n_steps = 0;
    for (const std::size_t start = solver.n_searches(); solver.n_searches() < start + n && n_steps < most_steps;
         ++n_steps)
      t += solver.step(1.0, t).dt;
    return n_steps;
  };
  advance_past_searches(2);
  const std::size_t n_cycles = std::clamp<std::size_t>(200'000 / result.n_particles, 1, 20);
  result.seconds_per_step = 1e30;
  for (int run = 0; run < 3; ++run) {
    const std::size_t searches = solver.n_searches();
    const auto start = std::chrono::steady_clock::now();
    const int n_steps = advance_past_searches(n_cycles);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (seconds / n_steps >= result.seconds_per_step) continue;
    result.seconds_per_step = seconds / n_steps;
    result.steps_per_search =
        static_cast<double>(n_steps) / static_cast<double>(std::max<std::size_t>(1, solver.n_searches() - searches));
  }
  result.stage_shares = observe_stages(solver, [&] { advance_past_searches(n_cycles); });
  result.bytes_per_particle = (peak_memory() - before) * 1048576.0 / static_cast<double>(result.n_particles);
  result.neighbours = mean_neighbours(solver);
  return result;
}

}  // namespace

StepBenchResult bench_step(std::size_t n_particles, const StepBenchTerms& terms) {
  return run_in_child([&] { return time_steps(n_particles, terms); });
}

}  // namespace smelt
