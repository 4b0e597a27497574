#pragma once
// What a shot will take, before it starts.

#include "scenes/scene.h"

#include <optional>
#include <string>
#include <vector>

namespace smelt {

struct SceneForecast {
  std::size_t n_particles = 0;      ///< at the start
  std::size_t n_particles_end = 0;  ///< with what is poured in; what flows out is not foreseen
  double spacing = 0.0;             ///< [m]
  double body_volume = 0.0;         ///< [m^3]
  double sound_speed = 0.0;         ///< [m/s]
  double time_step = 0.0;           ///< at the start [s]
  std::string time_step_term;       ///< what sets it
  double n_steps = 0.0;             ///< in the whole shot, at that time step
  double simulate_seconds = 0.0;    ///< from the pace of a few steps on this machine
  double surface_seconds = 0.0;     ///< from the surface of the particles that those steps were made with
  double render_seconds = 0.0;      ///< from small pictures of it
  /// The seconds are those of an idle machine, which this one is not: everything takes so many times as long now.
  /// Nothing where the machine was never calibrated, and the seconds are those of the machine as it is now.
  std::optional<double> load;
  double bytes = 0.0;  ///< memory of the particles, their neighbour lists and passes
  std::vector<std::string> warnings;
  std::vector<std::string> advice;  ///< settings badly chosen, and what to choose
};

/// Builds the simulation and takes `n_trial_steps` steps of it; where all particles are poured in later, of a layer of
/// them on the ground under the vent, or of a block of them where there is none. Then, `with_pictures`, surfaces and
/// renders the outcome, in a temporary folder and at a fraction of its resolution.
SceneForecast forecast_scene(const Scene& scene, int n_trial_steps = 40, bool with_pictures = true);

}  // namespace smelt
