#include "scenes/machine_pace.h"

#include "core/error.h"
#include "core/sph/solver.h"
#include "io/atomic_file.h"
#include "scenes/machine.h"
#include "scenes/version.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

namespace smelt {

namespace {

/// A cube of a Newtonian fluid that floats: pair loops, stress and a neighbour search, as most of any shot is.
Solver<3, float> make_fixed_work() {
  constexpr int edge = 20;
  constexpr double spacing = 0.01, density = 1000.0;
  SolverParameters<3> parameters;
  parameters.particle_volume = spacing * spacing * spacing;
  parameters.smoothing_length = 1.2 * spacing;
  parameters.sound_speed = 10.0;
  parameters.xsph = 0.3;
  Material fluid;
  fluid.density = density;
  fluid.rheology.consistency = {1.0, 1.0};
  fluid.rheology.index = 1.0;
  Particles<3> cube;
  for (int k = 0; k < edge * edge * edge; ++k) {
    cube.id.push_back(k);
    cube.position.push_back(spacing * Vec3(k % edge, k / edge % edge, k / (edge * edge)));
    cube.velocity.push_back(Vec3::Zero());
    cube.density.push_back(density);
  }
  return {parameters, {fluid}, Colliders<3>(), std::move(cube)};
}

/// What the pace depends on beside other work: a home folder may be shared by many machines.
nlohmann::json describe_here() {
  return {{"cpu", cpu_name()}, {"threads", std::thread::hardware_concurrency()}, {"smelt", version}};
}

}  // namespace

std::filesystem::path pace_file() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache)
    return std::filesystem::path(cache) / "smelt" / "pace.json";
  const char* home = std::getenv("HOME");
  return std::filesystem::path(home && *home ? home : "/tmp") / ".cache" / "smelt" / "pace.json";
}

double time_fixed_work() {
  double best = 1e30;
  for (int run = 0; run < 15; ++run) {
    Solver<3, float> solver = make_fixed_work();
    const auto start = std::chrono::steady_clock::now();
    solver.prepare();
    double t = 0.0;
    for (int step = 0; step < 20; ++step) t += solver.step(1.0, t).dt;
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best;
}

double calibrate_pace() {
  const double seconds = time_fixed_work();
  std::error_code ignored;
  std::filesystem::create_directories(pace_file().parent_path(), ignored);  // writing says what is wrong
  nlohmann::json pace = describe_here();
  pace["fixed_work_seconds"] = seconds;
  write_file_atomically(pace_file(), pace.dump(2) + "\n");
  return seconds;
}

std::optional<double> measure_load() {
  std::ifstream file(pace_file());
  if (!file) return std::nullopt;
  const nlohmann::json pace = nlohmann::json::parse(file, nullptr, false);
  if (!pace.is_object() || !pace.contains("fixed_work_seconds") || !pace["fixed_work_seconds"].is_number())
    fail("{}: not a pace; `./smelt bench --calibrate` writes it anew", pace_file().string());
  const double calibrated = pace["fixed_work_seconds"];
  if (!(calibrated > 0.0))
    fail("{}: fixed_work_seconds must be > 0, is {}; `./smelt bench --calibrate` writes it anew", pace_file().string(),
         calibrated);
  const nlohmann::json here = describe_here();
  for (const auto& [key, value] : here.items())
    if (!pace.contains(key) || pace[key] != value) return std::nullopt;
  return std::max(1.0, time_fixed_work() / calibrated);
}

}  // namespace smelt
