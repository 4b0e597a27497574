#include "bench/cases/knobs.h"

#include "bench/cases/cpu_clock.h"
#include "bench/cases/set_up.h"
#include "bench/cases/smd_channel.h"
#include "bench/cases/surfacing.h"
#include "surfacing/surface.h"

#include <cmath>
#include <functional>
#include <string>
#include <utility>

namespace smelt::knobs {

namespace {

template <typename Settings>
struct Knob {
  std::string name;
  std::function<void(Settings&)> turn;
};

template <typename Settings>
std::vector<std::string> names_of(const std::vector<Knob<Settings>>& all) {
  std::vector<std::string> names;
  for (const auto& knob : all) names.push_back(knob.name);
  return names;
}

using Flow = SolverParameters<2>;

/// The first is what the others are compared with.
const std::vector<Knob<Flow>>& flow_knobs() {
  static const std::vector<Knob<Flow>> all{{"CFL 0.4, cubic spline, h = 1.3 spacings", [](Flow&) {}},
                                           {"CFL 0.25", [](Flow& p) { p.courant = 0.25; }},
                                           {"CFL 0.1", [](Flow& p) { p.courant = 0.1; }},
                                           {"h = 1.2 spacings", [](Flow& p) { p.smoothing_length *= 1.2 / 1.3; }},
                                           {"h = 1.5 spacings", [](Flow& p) { p.smoothing_length *= 1.5 / 1.3; }},
                                           {"quintic spline, h = 1 spacing",
                                            [](Flow& p) {
                                              p.kernel = KernelType::quintic_spline;
                                              p.smoothing_length /= 1.3;
                                            }},
                                           {"quadratic kernel", [](Flow& p) { p.kernel = KernelType::quadratic; }},
                                           {"XSPH 0.3", [](Flow& p) { p.xsph = 0.3; }},
                                           {"artificial viscosity 0.2", [](Flow& p) { p.artificial_viscosity = 0.2; }},
                                           {"corrected divergence", [](Flow& p) { p.corrected_divergence = true; }},
                                           {"no hourglass control", [](Flow& p) { p.hourglass_control = 0.0; }},
                                           {"lists reach 0.02 h further", [](Flow& p) { p.skin = 0.02; }},
                                           {"lists reach 0.3 h further", [](Flow& p) { p.skin = 0.3; }}};
  return all;
}

Measurement run_flow(std::size_t method, double across) {
  const int n = static_cast<int>(across);
  constexpr double jump = 150.0;
  const Reference reference = smd_channel::read_profile(static_cast<int>(jump));
  const CpuClock clock;
  Solver<2, double> solver = smd_channel::make_channel(n, jump, flow_knobs()[method].turn);
  solver.prepare();
  advance_by(solver, smd_channel::steady_time);
  const double seconds = clock.seconds();
  return {.error = smd_channel::measure(solver.particles(), reference, n).velocity,
          .cpu_seconds = seconds,
          .n_particles = solver.particles().size()};
}

const std::vector<Knob<SurfacingOptions>>& surface_knobs() {
  static const std::vector<Knob<SurfacingOptions>> all{
      {"cells of 0.5 spacings, flattened kernels, 30 passes", [](SurfacingOptions&) {}},
      {"cells of 1 spacing", [](SurfacingOptions& o) { o.cell_over_spacing = 1.0; }},
      {"cells of 0.75 spacings", [](SurfacingOptions& o) { o.cell_over_spacing = 0.75; }},
      {"cells of 0.25 spacings", [](SurfacingOptions& o) { o.cell_over_spacing = 0.25; }},
      {"round kernels", [](SurfacingOptions& o) { o.anisotropic = false; }},
      {"no smoothing", [](SurfacingOptions& o) { o.smoothing_passes = 0; }}};
  return all;
}

/// The ball of particles 10 spacings in radius per 20 across, shaken, and the normals of its surface.
Measurement run_surface(std::size_t method, double across) {
  constexpr double radius = 1.0;
  ParticleFrame frame = surfacing_cases::make_ball(radius, 2.0 * radius / across);
  surfacing_cases::jitter(frame, 0.1);
  SurfacingOptions options;
  surface_knobs()[method].turn(options);
  const CpuClock clock;
  const SurfaceMesh surface = build_surface(frame, options);
  const double seconds = clock.seconds();
  return {.error = surfacing_cases::measure_ball(surface, frame, radius).normals,
          .cpu_seconds = seconds,
          .n_particles = frame.size()};
}

}  // namespace

Case make_flow_case() {
  return {
      .name = "knobs_flow",
      .title = "Knobs: a flow",
      .measures =
          "What one setting changed costs and buys in the viscoplastic channel (jump number 150): the first line is "
          "what the others are compared with.",
      .good =
          "Within 2 %, as in the channel's own case; a setting pays where its line lies left of the first or below it.",
      .good_errors = {0.02},
      .error_label = "velocity: L2 error / L2",
      .resolution_label = "particles across the channel",
      .methods = names_of(flow_knobs()),
      .quick = {20, 30, 40},
      .full = {20, 30, 40, 60},
      .run = run_flow};
}

Case make_surface_case() {
  return {
      .name = "knobs_surface",
      .title = "Knobs: a surface",
      .measures =
          "What one setting changed costs and buys in the normals (root mean square angle) of the surface of a ball of "
          "shaken particles.",
      .good = "Within 0.05 rad (3 degrees).",
      .good_errors = {0.05},
      .error_label = "normals [rad]",
      .resolution_label = "particles across the ball",
      .methods = names_of(surface_knobs()),
      .quick = {10, 20, 40},
      .full = {10, 20, 40, 80},
      .run = run_surface};
}

}  // namespace smelt::knobs
