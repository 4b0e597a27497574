// What the parameters must be, what bounds a step, and whether the state is still sound after it.
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
        return compute_sound_speed(state, parameters_.sound_speed, material(i).density, particles_.density[i],
                                   internal_energy(i));
      },
      [](double a, double b) { return std::max(a, b); });
}

template <int Dim, typename Real>
void Solver<Dim, Real>::check_parameters() const {
  const SolverParameters<Dim>& p = parameters_;
  if (particles_.size() == 0 && p.emitters.empty()) fail("simulation: there are no particles");
  if (!(p.particle_volume > 0.0) || !(p.smoothing_length > 0.0) || !(p.sound_speed > 0.0 || terms_.gas))
    fail("simulation: particle volume, smoothing length and sound speed must be > 0, are {}, {}, {}", p.particle_volume,
         p.smoothing_length, p.sound_speed);
  if (terms_.diffusion && p.density != DensityForm::continuity)
    fail(
        "simulation: density diffusion goes with the continuity equation; a density that is a sum has nothing to "
        "diffuse (set it to 0)");
  if (p.corrected_divergence && (!terms_.pair.stress || p.density != DensityForm::continuity))
    fail(
        "simulation: the corrected divergence needs a material with a viscosity, and the continuity equation for the "
        "density");
  if (terms_.gas && (terms_.pair.stress || terms_.pair.has_heat()))
    fail("simulation: an ideal gas has no viscosity and conducts no heat");
  if (terms_.gas && !(p.equation_of_state.adiabatic_index > 1.0))
    fail("simulation: the adiabatic index must be > 1, is {}", p.equation_of_state.adiabatic_index);
  if (!terms_.gas && p.quadratic_artificial_viscosity != 0.0)
    fail("simulation: quadratic artificial viscosity is for an ideal gas; shocks in liquids are weak");
  if (terms_.gas && (colliders_.has_walls() || terms_.diffusion))
    fail("simulation: walls and density diffusion are for liquids, not for an ideal gas");
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

// -------------------------------------------------------------------------------------------------------- watchfulness

namespace {

template <int Dim>
std::string place_of(const Vec<Dim>& x) {
  std::string place;
  for (int a = 0; a < Dim; ++a) place += fmt::format("{}{:.6g}", a ? ", " : "", x[a]);
  return fmt::format("({}) m", place);
}

/// The first of the particles at which `value` is largest.
template <typename Value>
std::size_t find_largest(std::size_t n, const Value& value) {
  std::size_t largest = 0;
  for (std::size_t i = 1; i < n; ++i)
    if (value(i) > value(largest)) largest = i;
  return largest;
}

}  // namespace

/// Names what bounds the step, and how to mend it.
template <int Dim, typename Real>
void Solver<Dim, Real>::fail_at_step(const TimeStep& step, double time) const {
  const auto& p = particles_;
  const auto particle = [&](const auto& value) {
    const std::size_t i = find_largest(p.size(), value);
    return fmt::format("particle {} at {}", p.id[i], place_of<Dim>(p.position[i]));
  };
  const TimeStepInput input = time_step_input();
  std::string why;
  switch (step.term) {
    case TimeStepTerm::acoustic: {
      const double of_colliders = colliders_.speed_bound(time, time);
      why = of_colliders > input.max_speed
                ? fmt::format("a collider moves at {:.3g} m/s: slow it, or take a coarser spacing", of_colliders)
                : fmt::format(
                      "{} moves at {:.3g} m/s where pressure waves go at {:.3g} m/s: lower [solver] "
                      "sound_speed_m_s, or take a coarser spacing",
                      particle([&](std::size_t i) { return p.velocity[i].squaredNorm(); }), input.max_speed,
                      input.wave_speed);
      break;
    }
    case TimeStepTerm::viscous:
      why = fmt::format(
          "{} has a kinematic viscosity of {:.3g} m2/s: lower its viscosity, or give [solver] "
          "shear_wave_speed_m_s, with which none limits the step",
          particle([&](std::size_t i) { return p.viscosity[i] / p.density[i]; }), input.max_kinematic_viscosity);
      break;
    case TimeStepTerm::acceleration:
      why = fmt::format(
          "{} is accelerated by {:.3g} m/s2: look at what stands there; a higher [solver] "
          "sound_speed_m_s or a lower [time_step] courant may help",
          particle([&](std::size_t i) { return acceleration(i).squaredNorm(); }), input.max_acceleration);
      break;
    case TimeStepTerm::conduction:
      why = fmt::format(
          "heat diffuses at {:.3g} m2/s: lower the material's heat.diffusivity_m2_s, or take a coarser "
          "spacing",
          input.max_diffusivity);
      break;
    default:
      why = "lower [solver] density_diffusion or sound_speed_m_s, or take a coarser spacing";
  }
  throw DivergedError(fmt::format(
      "the time step collapsed to {:.3g} s (floor {:.3g} s) at t = {:.6g} s, limited by the {} term: {}; or lower "
      "[time_step] min_s",
      step.dt, parameters_.min_time_step, time, time_step_term_names[static_cast<std::size_t>(step.term)], why));
}

template <int Dim, typename Real>
void Solver<Dim, Real>::check_state(double time) const {
  const auto& p = particles_;
  const Box<Dim>& domain = parameters_.domain;
  const bool bounded = !domain.empty();
  const auto broken_term = [&](std::size_t i) -> const char* {
    const double relative_density = p.density[i] / material(i).density;
    // A gas has no density at rest; a liquid has no business far from it.
    if (!(terms_.gas ? relative_density > 0.0 && std::isfinite(relative_density)
                     : relative_density > 0.1 && relative_density < 10.0))
      return "the density";
    if (terms_.gas && !(p.internal_energy[i] > 0.0 && std::isfinite(p.internal_energy[i])))
      return "the internal energy";
    if (terms_.pair.has_heat() && !(p.temperature[i] >= 0.0 && std::isfinite(p.temperature[i])))
      return "the temperature (heat equation)";
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
  throw DivergedError(fmt::format(
      "the simulation diverged at t = {:.6g} s: {} of particle {} at {} went wrong (density {:.6g} kg/m3, speed "
      "{:.6g} m/s); a higher [solver] sound_speed_m_s or a lower [time_step] courant helps",
      time, broken_term(i), p.id[i], place_of<Dim>(p.position[i]), p.density[i], p.velocity[i].norm()));
}

template class Solver<3, float>;
template class Solver<3, double>;
template class Solver<2, double>;
template class Solver<1, double>;

}  // namespace smelt
