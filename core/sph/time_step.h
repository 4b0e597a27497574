#pragma once
// The adaptive time step  [P 5-12, 6-17].

#include <array>
#include <cstddef>
#include <string_view>

namespace smelt {

/// What set a time step.
enum class TimeStepTerm { acoustic, viscous, acceleration, conduction, density_diffusion, frame_end };
inline constexpr std::size_t n_time_step_terms = 6;
inline constexpr std::array<std::string_view, n_time_step_terms> time_step_term_names = {
    "acoustic", "viscous", "acceleration", "conduction", "density_diffusion", "frame_end"};

/// The extremes that bound a step.
struct TimeStepInput {
  double smoothing_length = 0.0;  ///< h [m]
  double wave_speed = 0.0;        ///< of pressure waves, with shear stiffness where there is any [m/s]
  double max_speed = 0.0;         ///< [m/s]
  double max_acceleration = 0.0;  ///< [m/s^2]
  double max_kinematic_viscosity =
      0;                         ///< eta/rho where the stress follows the strain rate at once [m^2/s]; 0: no such limit
  double max_diffusivity = 0.0;  ///< of heat [m^2/s]
  double density_diffusivity = 0.0;  ///< delta h c [m^2/s]
};

struct TimeStep {
  double dt = 0.0;  ///< [s]
  TimeStepTerm term = TimeStepTerm::acoustic;
};

/// dt = C min(h/(|v| + c), h^2 rho/(8 eta), sqrt(h/|a|)), h^2/(8 k) and h^2/(6 D), with the Courant factor C (0.1 in
/// [P 6-17]), k the diffusivity of heat and D that of density: no mode of 2 D sum V_j F (p_j - p_i) decays faster than
/// 4 D sum V_j |F| = 12 D/h^2 (cubic spline), and a step explicit in time holds up to twice the time of the fastest.
TimeStep compute_time_step(const TimeStepInput& input, double courant);

/// The step to take when `remaining` [s] are left to the end of the frame: the last two steps share what is left, so
/// that none is tiny.
TimeStep fit_to_frame(const TimeStep& step, double remaining);

}  // namespace smelt
