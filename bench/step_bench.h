#pragma once
// How fast a step is: particle-steps a second of a melting heap on a floor.

#include "core/sph/solver.h"

#include <array>
#include <cstddef>

namespace smelt {

/// What the heap asks of the solver.
struct StepBenchTerms {
  bool viscoplastic = true;  ///< Souza Mendes-Dutra; else Newtonian
  bool heat = true;          ///< with melting
  bool walls = true;         ///< a floor of two triangles; else the heap floats, without gravity
  bool hourglass = true;     ///< hourglass control, on by default in scenes
  bool xsph = true;
};

struct StepBenchResult {
  std::size_t n_particles = 0;
  double neighbours = 0.0;          ///< in the support, mean
  double seconds_per_step = 0.0;    ///< least of three runs
  double steps_per_search = 0.0;    ///< steps from one search for neighbours to the next, mean
  double bytes_per_particle = 0.0;  ///< at the peak of a process that does nothing else
  std::array<double, step_stage_names.size()> stage_shares{};  ///< of the time of a step, by StepStage
  double particle_steps_per_second() const { return static_cast<double>(n_particles) / seconds_per_step; }
};

/// Times steps of a heap of about `n_particles`, twice as wide as high, its lattice jittered, whose upper half is
/// molten. Steps are timed in three runs from one search for neighbours to the next, in small heaps to the twentieth
/// next.
StepBenchResult bench_step(std::size_t n_particles, const StepBenchTerms& terms = {});

}  // namespace smelt
