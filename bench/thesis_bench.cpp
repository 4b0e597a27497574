#include "bench/thesis_bench.h"

#include "scenes/build_simulation.h"
#include "scenes/scene_reader.h"

#include <algorithm>
#include <chrono>

namespace smelt {

namespace {

/// Steps before the clock starts, and on the clock: the neighbours are searched for several times.
constexpr int n_warm_up = 20, n_timed = 100;

const ThesisShot shots[] = {{"hand", 5000, 0.13},     {"wall", 5000, 0.09},    {"chair", 7000, 0.15},
                            {"bunny", 10188, 0.18},   {"candle", 7364, 0.11},  {"gargoyle", 7007, 0.16},
                            {"letters", 10773, 0.13}, {"terrain", 4900, 0.08}, {"sugarloaf", 10137, 0.48}};

/// When the last vent closes [s]; 0 without vents.
double pouring_ends(const Scene& scene) {
  double end = 0.0;
  for (const EmitterSettings& emitter : scene.emitters)
    end = std::max(end, emitter.end.value_or(scene.shot.frames / scene.shot.fps));
  return end;
}

template <typename Real>
ThesisBenchResult time_steps(const Scene& scene) {
  SimulationSetup setup = build_simulation(scene);
  Solver<3, Real> solver(setup.parameters, setup.materials, build_colliders(setup), std::move(setup.particles));
  // Frame by frame, as a shot is run: a step ends where its frame does.
  double t = 0.0, remaining = 0.0;
  const auto step = [&] {
    if (remaining <= 0.0) {
      solver.prepare(t);
      remaining = 1.0 / scene.shot.fps;
    }
    const double dt = solver.step(remaining, t).dt;
    remaining -= dt;
    t += dt;
  };
  for (const double poured = pouring_ends(scene); t < poured;) step();
  for (int k = 0; k < n_warm_up; ++k) step();
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < n_timed; ++k) step();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return {solver.particles().size(), seconds / n_timed};
}

}  // namespace

std::span<const ThesisShot> thesis_shots() {
  return shots;
}

std::filesystem::path scene_file(const ThesisShot& shot) {
  return smelt_folder() / "scenes" / "thesis" / (shot.name + ".toml");
}

ThesisBenchResult bench_thesis_shot(const ThesisShot& shot) {
  const Scene scene = read_scene(scene_file(shot));
  return scene.solver.precision == "double" ? time_steps<double>(scene) : time_steps<float>(scene);
}

}  // namespace smelt
