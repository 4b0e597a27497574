#pragma once
// What a shot will take, before it starts.

#include "scenes/scene.h"

#include <string>
#include <vector>

namespace smelt {

struct SceneForecast {
  std::size_t n_particles = 0;    ///< at the start
  std::size_t n_particles_end = 0;  ///< with what is poured in; what flows out is not foreseen
  double spacing = 0.0;           ///< [m]
  double body_volume = 0.0;       ///< [m^3]
  double sound_speed = 0.0;       ///< [m/s]
  double time_step = 0.0;         ///< at the start [s]
  std::string time_step_term;     ///< what sets it
  double n_steps = 0.0;           ///< in the whole shot, at that time step
  double simulate_seconds = 0.0;  ///< from the pace of a few steps on this machine, as it is now
  double bytes = 0.0;             ///< memory of the particles, their neighbour lists and passes
  std::vector<std::string> warnings;
  std::vector<std::string> advice;  ///< settings badly chosen, and what to choose
};

/// Builds the simulation and takes `n_trial_steps` steps of it; where all particles are poured in later, of a block of them in free flight.
SceneForecast forecast_scene(const Scene& scene, int n_trial_steps = 20);

}  // namespace smelt
