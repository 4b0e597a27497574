#include "bench/surfacer_bench.h"

#include "bench/peak_memory.h"
#include "core/geometry/triangle_mesh.h"
#include "surfacing/surface.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

namespace smelt {
namespace {

constexpr double spacing = 0.01;

/// Particles a quarter of a spacing off a lattice at most, as a fluid's are.
class Filler {
 public:
  explicit Filler(ParticleFrame& frame) : frame_(frame) {}

  void add(double i, double j, double k) {
    const auto jitter = [&] { return uniform_(random_); };
    const double x = i + jitter(), y = j + jitter(), z = k + jitter();
    frame_.position.push_back(spacing * Vec3(x, y, z));
    frame_.velocity.push_back(Vec3f(0.1f, -1.0f, 0.0f));
    frame_.density.push_back(1000.0f);
    frame_.temperature.push_back(300.0f + static_cast<float>(0.1 * y));
    frame_.id.push_back(static_cast<std::int32_t>(frame_.id.size()));
  }

 private:
  ParticleFrame& frame_;
  std::mt19937 random_{1};
  std::uniform_real_distribution<double> uniform_{-0.25, 0.25};
};

ParticleFrame empty_frame() {
  ParticleFrame frame;
  frame.spacing = spacing;
  frame.smoothing_length = 1.2 * spacing;
  frame.mass = 1000.0 * spacing * spacing * spacing;
  frame.frame = 1;
  return frame;
}

ParticleFrame make_ball(double n) {
  ParticleFrame frame = empty_frame();
  Filler filler(frame);
  const double radius = std::cbrt(3.0 * n / (4.0 * std::numbers::pi)), r = std::ceil(radius);
  for (double k = -r; k <= r; ++k)
    for (double j = -r; j <= r; ++j)
      for (double i = -r; i <= r; ++i)
        if (i * i + j * j + k * k < radius * radius) filler.add(i, j, k);
  return frame;
}

/// A choppy pool a tenth as deep as wide; above it thin sheets, and one particle in a hundred flies alone.
ParticleFrame make_splash(double n) {
  ParticleFrame frame = empty_frame();
  Filler filler(frame);
  const double width = std::cbrt(10.0 * n), depth = 0.1 * width;
  const auto height = [&](double x, double z) {
    return depth * (0.93 + 0.25 * std::sin(0.21 * x) * std::cos(0.17 * z) +
                    0.2 * std::sin(40.0 * x / width + 25.0 * z / width));
  };
  for (double k = 0; k < width; ++k)
    for (double j = 0; j < 2.0 * depth; ++j)
      for (double i = 0; i < width; ++i) {
        const bool sheet =
            j < 1.6 * depth && std::abs(std::hypot(i - 0.5 * width, k - 0.5 * width) - 0.2 * width - 0.2 * j) < 0.75;
        if (j < height(i, k) || sheet) filler.add(i, j, k);
      }
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(0.0, width);
  for (int drop = 0; drop < static_cast<int>(0.01 * n); ++drop)
    filler.add(place(random), 1.5 * depth + 0.1 * place(random), place(random));
  return frame;
}

struct Case {
  std::string what;
  SurfacingOptions options;
  double bar;        ///< million particles a second on two cores
  double bar_bytes;  ///< peak memory
};

struct Timing {
  double seconds = 1e300;  ///< best of the runs
  double mebibytes = 0.0;  ///< resident at the peak, particles included
  SurfaceMesh surface;
};

Timing measure(const ParticleFrame& frame, const SurfacingOptions& options, int n_runs) {
  Timing timing;
  for (int run = 0; run < n_runs; ++run) {
    timing.surface = {};
    reset_peak_memory();
    const auto start = std::chrono::steady_clock::now();
    timing.surface = build_surface(frame, options);
    timing.seconds =
        std::min(timing.seconds, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    timing.mebibytes = std::max(timing.mebibytes, peak_memory());
  }
  return timing;
}

bool print_case(const char* shape, const ParticleFrame& frame, const Case& c, int n_runs) {
  const Timing timing = measure(frame, c.options, n_runs);
  const double rate = 1e-6 * static_cast<double>(frame.size()) / timing.seconds;
  const bool met =
      rate >= c.bar && timing.mebibytes * 1048576.0 <= c.bar_bytes && compute_topology(timing.surface.mesh).closed();
  fmt::print("| {} | {} | {} | {:.3f} | {:.2f} | {} | {:.0f} | {} | {} |\n", shape, frame.size(), c.what,
             timing.seconds, rate, c.bar > 0.0 ? fmt::format("{}", c.bar) : "", timing.mebibytes,
             timing.surface.mesh.triangles.size(), met ? "yes" : "NO");
  return met;
}

}  // namespace

bool bench_surfacer(bool large) {
  SurfacingOptions coarse, fine;
  coarse.cell_over_spacing = 0.75;
  coarse.anisotropic = false;  // as the surfacer that the bar comes from
  fine.cell_over_spacing = 0.5;
  constexpr double gibibyte = 1024.0 * 1048576.0;
  const Case at_075{"cell 0.75", coarse, 0.9, 8.0 * gibibyte};
  const Case at_05{"cell 0.5, anisotropic", fine, 0.15, 8.0 * gibibyte};

  fmt::print("Threads: {}\n", tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  fmt::print(
      "| shape | particles | setting | s | million particles/s | bar | peak MiB | triangles | met |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  bool all_met = true;
  for (const double n : {1e5, 1e6}) {
    const ParticleFrame ball = make_ball(n), splash = make_splash(n);
    for (const Case& c : {at_075, at_05}) {
      all_met &= print_case("ball", ball, c, 3);
      all_met &= print_case("splash", splash, c, 3);
    }
  }
  if (large) {
    all_met &= print_case("ball", make_ball(1e7), at_075, 1);
    all_met &= print_case("splash", make_splash(1e7), at_075, 1);
  }
  return all_met;
}

}  // namespace smelt
