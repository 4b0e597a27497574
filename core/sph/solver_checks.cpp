// What bounds a step, and whether the state is still sound after it.
#include "core/error.h"
#include "core/parallel.h"
#include "core/sph/solver.h"

#include <algorithm>
#include <cmath>

namespace smelt {

/// Largest sound speed of any particle [m/s].
template <int Dim, typename Real>
double Solver<Dim, Real>::fastest_sound() const {
  const EquationOfState& state = parameters_.equation_of_state;
  if (state.law == PressureLaw::linear) return parameters_.sound_speed;
  return deterministic_reduce(
      particles_.size(), 0.0,
      [&](std::size_t i) {
        return compute_sound_speed(state, parameters_.sound_speed, material(i).density, particles_.density[i], internal_energy(i));
      },
      [](double a, double b) { return std::max(a, b); });
}

template <int Dim, typename Real>
TimeStepInput Solver<Dim, Real>::time_step_input() const {
  TimeStepInput input;
  input.smoothing_length = parameters_.smoothing_length;
  const double c = fastest_sound();
  const double shear = terms_.relaxed ? parameters_.shear_wave_speed : 0.0;
  input.wave_speed = std::sqrt(c * c + 4.0 / 3.0 * shear * shear);
  struct Extremes {
    double speed2 = 0.0, acceleration2 = 0.0, viscosity = 0.0;
  };
  const bool limited_by_viscosity = terms_.pair.stress && !terms_.relaxed;
  const Extremes extremes = deterministic_reduce(
      particles_.size(), Extremes{},
      [&](std::size_t i) {
        const double nu = limited_by_viscosity ? particles_.viscosity[i] / particles_.density[i] : 0.0;
        return Extremes{particles_.velocity[i].squaredNorm(), acceleration(i).squaredNorm(), nu};
      },
      [](const Extremes& a, const Extremes& b) {
        return Extremes{std::max(a.speed2, b.speed2), std::max(a.acceleration2, b.acceleration2),
                        std::max(a.viscosity, b.viscosity)};
      });
  input.max_speed = std::sqrt(extremes.speed2);
  input.max_acceleration = std::sqrt(extremes.acceleration2);
  input.max_kinematic_viscosity = extremes.viscosity;
  for (const Material& m : materials_)
    if (m.heat) input.max_diffusivity = std::max(input.max_diffusivity, m.heat->diffusivity);
  input.density_diffusivity = parameters_.density_diffusion * parameters_.smoothing_length * parameters_.sound_speed;
  return input;
}

/// What the fluid allows, less where colliders move faster than it within that time.
template <int Dim, typename Real>
TimeStep Solver<Dim, Real>::find_time_step(double remaining, double time) const {
  TimeStepInput input = time_step_input();
  const TimeStep without = compute_time_step(input, parameters_.courant);
  if (colliders_.empty()) return without;
  input.max_speed = std::max(input.max_speed, colliders_.speed_bound(time, time + std::min(without.dt, remaining)));
  return compute_time_step(input, parameters_.courant);
}

// ------------------------------------------------------------------------------------------------------------- watchfulness

template <int Dim, typename Real>
void Solver<Dim, Real>::check_state(double time) const {
  const auto& p = particles_;
  const Box<Dim>& domain = parameters_.domain;
  const bool bounded = !domain.empty();
  const auto broken_term = [&](std::size_t i) -> const char* {
    const double relative_density = p.density[i] / material(i).density;
    // A gas has no density at rest; a liquid has no business far from it.
    if (!(terms_.gas ? relative_density > 0.0 && std::isfinite(relative_density) : relative_density > 0.1 && relative_density < 10.0))
      return "the density";
    if (terms_.gas && !(p.internal_energy[i] > 0.0 && std::isfinite(p.internal_energy[i]))) return "the internal energy";
    if (terms_.pair.has_heat() && !(p.temperature[i] >= 0.0 && std::isfinite(p.temperature[i]))) return "the temperature (heat equation)";
    if (terms_.pair.stress && !p.stress[i].allFinite()) return "the extra stress (rheology)";
    if (!specific_force_[i].allFinite()) return "the acceleration (pressure and stress forces)";
    if (!p.velocity[i].allFinite() || !p.position[i].allFinite()) return "the velocity (leap-frog)";
    if (bounded && ((p.position[i] - domain.lower).array() < 0.0 || (domain.upper - p.position[i]).array() < 0.0).any())
      return "the position (it left the domain)";
    return nullptr;
  };
  constexpr std::int32_t none = std::numeric_limits<std::int32_t>::max();
  const std::int32_t first = deterministic_reduce(
      p.size(), none, [&](std::size_t i) { return broken_term(i) ? static_cast<std::int32_t>(i) : none; },
      [](std::int32_t a, std::int32_t b) { return std::min(a, b); });
  if (first == none) return;
  const auto i = static_cast<std::size_t>(first);
  std::string at;
  for (int a = 0; a < Dim; ++a) at += fmt::format("{}{:.6g}", a ? ", " : "", p.position[i][a]);
  throw DivergedError(fmt::format(
      "the simulation diverged at t = {:.6g} s: {} of particle {} at ({}) m went wrong (density {:.6g} kg/m3, speed {:.6g} m/s); a "
      "higher [solver] sound_speed_m_s or a lower [time_step] courant helps",
      time, broken_term(i), p.id[i], at, p.density[i], p.velocity[i].norm()));
}

template class Solver<3, float>;
template class Solver<3, double>;
template class Solver<2, double>;
template class Solver<1, double>;

}  // namespace smelt
