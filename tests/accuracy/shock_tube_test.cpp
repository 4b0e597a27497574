// The shock tube of [S 4.5.1], table 5: density by summation, energy equation, artificial viscosity, against the exact
// Riemann solution.

#include "bench/cases/shock_tube.h"

#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace smelt {
namespace {

using namespace shock_tube;

TEST(ShockTube, ConvergesToTheRiemannSolution) {
  double previous = 0.0;
  for (const int refinement : {1, 2, 4}) {
    const auto profile = simulate(refinement);
    // [S]'s own 400 particles are measured without a bar, for comparison with its figures 16-19.
    const bool barred = refinement > 1;
    const auto report = [&](const std::string& quantity, double error, double bar) {
      report_row({.problem = "shock tube",
                  .quantity = quantity,
                  .resolution = fmt::format("{} particles", 400 * refinement),
                  .error = error,
                  .bar = barred ? std::optional(bar) : std::nullopt});
    };
    const double l1 = density_error(profile);
    // A shock and a contact are smeared over a fixed number of particles: order one at best.
    report_row({.problem = "shock tube",
                .quantity = "density L1 / mean",
                .resolution = fmt::format("{} particles", 400 * refinement),
                .error = l1,
                .bar = barred ? std::optional(0.02) : std::nullopt,
                .order = barred ? std::optional(std::log2(previous / l1)) : std::nullopt,
                .least_order = barred ? std::optional(0.85) : std::nullopt});
    previous = l1;
    // The fan ends at -0.057, the contact is at 0.101, the shock at 0.222.
    report("plateau left of the contact; density", plateau_error(profile, &Point::density, -0.03, 0.07), 0.01);
    report("plateau right of the contact; density", plateau_error(profile, &Point::density, 0.13, 0.19), 0.01);
    report("plateau; velocity", plateau_error(profile, &Point::velocity, -0.03, 0.19), 0.01);
    report("plateau; pressure", plateau_error(profile, &Point::pressure, -0.03, 0.19), 0.01);
  }
}

}  // namespace
}  // namespace smelt
