#pragma once
// The worst of a run, as rows of the table.

#include "bench/cases/watch.h"
#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

namespace smelt {

/// Reports both figures: no more energy than `energy_bar` of the kinetic energy at the start may appear; the density
/// error is stated.
inline void report_watched(const std::string& problem, const Watched& seen, std::size_t n_particles,
                           double energy_bar) {
  const std::string resolution = fmt::format("{} particles {} steps", n_particles, seen.steps);
  report_row({.problem = problem,
              .quantity = "energy gained / kinetic at start",
              .resolution = resolution,
              .error = seen.energy_gain,
              .bar = energy_bar});
  report_row(
      {.problem = problem, .quantity = "largest density error", .resolution = resolution, .error = seen.density_error});
}

}  // namespace smelt
