// What collision costs: a sheet of fluid that slides over bumpy terrain, for meshes of 1 thousand to 1 million
// triangles. The swept collision is what the drift takes more than without ground; the wall terms are timed stage by
// stage, looking up facets included.
//   bench_collision [layers] [cells]      of particles, 10 unless said (always some 10 thousand particles); of the
//   terrain along a side, one mesh alone

#include "bench/cases/set_up.h"
#include "core/parallel.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace smelt {
namespace {

constexpr double spacing = 0.05, density = 2500.0;

/// Bumps half a metre long and a fifth of a spacing high, all waves shorter than the ground is wide.
double ground(double x, double z) {
  return 0.2 * spacing * (std::sin(12.6 * x) * std::cos(12.6 * z) + std::sin(5.0 * x + 3.0 * z));
}

/// n x n cells of two triangles over [-half, half]^2.
Obstacle<3> make_terrain(int n, double half) {
  Obstacle<3> terrain;
  terrain.wall = true;
  const auto at = [&](int i, int k) {
    const double x = half * (2.0 * i / n - 1.0), z = half * (2.0 * k / n - 1.0);
    return Vec3(x, ground(x, z), z);
  };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      terrain.facets.push_back({at(i, k), at(i, k + 1), at(i + 1, k + 1)});
      terrain.facets.push_back({at(i, k), at(i + 1, k + 1), at(i + 1, k)});
    }
  return terrain;
}

struct Timing {
  double step = 0.0;       ///< [ms], best of three runs; the next two of the same run
  double drift = 0.0;      ///< [ms]
  double walls = 0.0;      ///< sums, gradients and forces of walls [ms]; what they add to the rates is among those
  std::size_t n_near = 0;  ///< particles within the support of the ground
  double nodes = 0.0;      ///< of the tree that a particle of the lowest layer looks into as it moves
};

/// As the step moves them: a wall's guard is a quarter of the spacing.
double mean_nodes_visited(const Particles<3>& lava, const Obstacle<3>& terrain, const SolverParameters<3>& parameters) {
  const SimplexBvh<3> bvh(terrain.facets);
  const double dt = 0.4 * parameters.smoothing_length / parameters.sound_speed;
  double nodes = 0.0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < lava.size(); ++i) {
    const Vec3& x = lava.position[i];
    if (x[1] - ground(x[0], x[2]) > spacing) continue;
    nodes += static_cast<double>(bvh.count_visits(x, dt * lava.velocity[i], 0.25 * spacing));
    ++n;
  }
  return nodes / static_cast<double>(n);
}

Timing time_steps(int n_layers, int n_cells, double half) {
  const int n_wide = static_cast<int>(std::lround(std::sqrt(10000.0 / n_layers)));
  Box<3> box;
  box.lower = Vec3(-0.5 * n_wide * spacing, 0.0, -0.5 * n_wide * spacing);
  box.upper = Vec3(0.5 * n_wide * spacing, n_layers * spacing, 0.5 * n_wide * spacing);
  const double depth = n_layers * spacing, speed = std::sqrt(2.0 * 9.81 * depth);
  auto parameters = make_parameters<3>(spacing, 10.0 * speed);
  parameters.shear_wave_speed = parameters.sound_speed;
  parameters.hourglass_control = 1.0;
  parameters.courant = 0.4;
  Timing best;
  best.step = 1e30;
  for (int run = 0; run < 3; ++run) {
    Particles<3> lava = make_block<3>(box, spacing, density, 0.05);
    for (std::size_t i = 0; i < lava.size(); ++i) {
      lava.position[i][1] += ground(lava.position[i][0], lava.position[i][2]);
      lava.velocity[i] = Vec3(0.5 * speed, 0.0, 0.0);
    }
    Colliders<3> colliders;
    if (n_cells > 0) {
      colliders.add(make_terrain(n_cells, half));
      parameters.gravity = Vec3(0.0, -9.81, 0.0);
    } else {
      parameters.gravity = Vec3::Zero();
    }
    if (n_cells > 0 && run == 0) best.nodes = mean_nodes_visited(lava, make_terrain(n_cells, half), parameters);
    best.n_near = 0;
    for (const Vec3& x : lava.position) best.n_near += x[1] - ground(x[0], x[2]) < 2.0 * parameters.smoothing_length;
    Solver<3, float> solver(parameters, {viscoplastic_material(density, 200.0, 300.0, 0.8, 100.0)},
                            std::move(colliders), std::move(lava));
    solver.prepare();
    std::array<double, step_stage_names.size()> taken{};
    auto last = std::chrono::steady_clock::now();
    solver.observe([&](StepStage stage) {
      const auto now = std::chrono::steady_clock::now();
      taken[static_cast<std::size_t>(stage)] += std::chrono::duration<double, std::milli>(now - last).count();
      last = now;
    });
    constexpr int n_steps = 60;
    double t = 0.0;
    for (int step = 0; step < n_steps; ++step) t += solver.step(1.0, t).dt;
    const auto of = [&](StepStage stage) { return taken[static_cast<std::size_t>(stage)] / n_steps; };
    const double whole = std::accumulate(taken.begin(), taken.end(), 0.0) / n_steps;
    if (whole >= best.step) continue;
    best.step = whole;
    best.drift = of(StepStage::drift);
    best.walls = of(StepStage::wall_sums) + of(StepStage::gradients) + of(StepStage::wall_forces);
  }
  return best;
}

}  // namespace
}  // namespace smelt

int main(int argc, char** argv) {
  using namespace smelt;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const int n_layers = argc > 1 ? std::atoi(argv[1]) : 10;
  const double n_wide = std::sqrt(10000.0 / n_layers);
  const double half = n_wide * spacing;  // the ground is twice as wide as the fluid
  const Timing alone = time_steps(n_layers, 0, half);
  fmt::print("{} layers, {} particles near the ground; a step without it takes {:.2f} ms\n", n_layers, alone.n_near,
             alone.step);
  fmt::print(
      "| triangles | edge / spacing | step, ms | swept collision | wall terms | us a particle near it | nodes looked "
      "into |\n|---|---|---|---|---|---|---|\n");
  const std::vector<int> meshes = argc > 2 ? std::vector<int>{std::atoi(argv[2])} : std::vector<int>{22, 71, 224, 707};
  for (const int n_cells : meshes) {
    const Timing with = time_steps(n_layers, n_cells, half);
    const double swept = with.drift - alone.drift;
    fmt::print("| {} | {:.2f} | {:.2f} | {:.1f} % | {:.1f} % | {:.2f} | {:.1f} |\n", 2 * n_cells * n_cells,
               2.0 * half / n_cells / spacing, with.step, 100.0 * swept / with.step, 100.0 * with.walls / with.step,
               1e3 * (swept + with.walls) / static_cast<double>(with.n_near), with.nodes);
  }
}
