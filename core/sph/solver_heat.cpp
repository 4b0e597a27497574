// Heat: what conduction, the free surface and walls do to temperature and enthalpy.
#include "core/error.h"
#include "core/parallel.h"
#include "core/sph/enthalpy.h"
#include "core/sph/free_surface.h"
#include "core/sph/rheology.h"
#include "core/sph/solver.h"
#include "core/sph/wall_terms.h"

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

void check_heat(const Material& m) {
  const HeatProperties& heat = *m.heat;
  if (heat.latent_heat < 0.0)
    fail("material \"{}\": its latent heat must be >= 0 J/kg, is {}", m.name, heat.latent_heat);
  if (heat.emissivity < 0.0 || heat.emissivity > 1.0)
    fail("material \"{}\": its emissivity must be from 0 to 1, is {}", m.name, heat.emissivity);
  if ((heat.latent_heat > 0.0 || heat.emissivity > 0.0) && !(heat.specific_heat > 0.0))
    fail("material \"{}\": latent heat and emissivity need its specific heat", m.name);
  if (!(heat.hot > heat.cold) && !(heat.latent_heat > 0.0 && heat.hot == heat.cold))
    fail("material \"{}\": hot_K = {} must be above cold_K = {}; only with latent heat may they be equal", m.name,
         heat.hot, heat.cold);
}

}  // namespace

template <int Dim, typename Real>
void Solver<Dim, Real>::set_up_heat() {
  terms_.exchange = parameters_.ambient.has_value() || !parameters_.heat_sources.empty();
  if (!terms_.pair.has_heat()) {
    if (terms_.exchange) fail("simulation: an ambient or heat sources are of no use where no material has heat");
    return;
  }
  terms_.ledger = true;
  const Material& first = materials_.front();
  for (const Material& m : materials_) {
    if (!m.heat) fail("simulation: either all materials have heat or none; \"{}\" has none", m.name);
    check_heat(m);
    if (m.heat->latent_heat > 0.0) terms_.latent_heat = true;
    if (!(m.heat->specific_heat > 0.0)) terms_.ledger = false;
    if (m.heat->emissivity > 0.0 && !parameters_.ambient)
      fail("simulation: material \"{}\" radiates, but there is no ambient temperature that it radiates to", m.name);
    if ((m.heat->specific_heat > 0.0) != (first.heat->specific_heat > 0.0))
      fail("simulation: either all materials have a specific heat or none");
  }
  if (terms_.exchange && !terms_.ledger)
    fail("simulation: heat through the free surface needs the specific heat of all materials");
  if (!terms_.latent_heat) return;
  if (particles_.enthalpy.empty()) {
    for (std::size_t i = 0; i < particles_.size(); ++i)
      particles_.enthalpy.push_back(enthalpy_at(*material(i).heat, particles_.temperature[i]));
    return;
  }
  CHECK_EQ(particles_.enthalpy.size(), particles_.size());
}

template <int Dim, typename Real>
double Solver<Dim, Real>::melted_fraction_of(std::size_t i) const {
  const HeatProperties& heat = *material(i).heat;
  if (terms_.latent_heat && heat.latent_heat > 0.0) return melted_fraction_at_enthalpy(heat, particles_.enthalpy[i]);
  return melted_fraction(heat, particles_.temperature[i]);
}

template <int Dim, typename Real>
double Solver<Dim, Real>::enthalpy(std::size_t i) const {
  return terms_.latent_heat ? particles_.enthalpy[i] : enthalpy_at(*material(i).heat, particles_.temperature[i]);
}

/// Areas change little while particles move by a fraction of a spacing.
template <int Dim, typename Real>
void Solver<Dim, Real>::find_free_surface() {
  travelled_at_surface_ = 0.0;
  std::vector<double> volume(particles_.size());
  parallel_for_each(volume.size(), [&](std::size_t i) { volume[i] = mass(i) / particles_.density[i]; });
  compute_free_surface_areas<Dim>({particles_.position, volume, images_, lists_, walls_ ? &*walls_ : nullptr,
                                   parameters_.kernel, parameters_.smoothing_length, spacing_},
                                  free_surface_area_);
}

/// Of sources of given power, over the surface that they reach now.
template <int Dim, typename Real>
void Solver<Dim, Real>::find_source_powers(double time) {
  power_density_.assign(parameters_.heat_sources.size(), 0.0);
  for (std::size_t k = 0; k < power_density_.size(); ++k) {
    const HeatSource<Dim>& source = parameters_.heat_sources[k];
    if (!source.power || !source.burns_at(time)) continue;
    const double weighted_area = deterministic_reduce(
        particles_.size(), 0.0,
        [&](std::size_t i) {
          // What a vent drives takes nothing up (advance_heat).
          return is_driven(i) ? 0.0 : free_surface_area_[i] * source.weight_at(particles_.position[i], time);
        },
        [](double a, double b) { return a + b; });
    if (weighted_area > 0.0) power_density_[k] = *source.power / weighted_area;
  }
}

/// rho c_p dT/dt = div(c_p rho0 k grad T), `conducted` the sum over pairs: the factor rho0/rho makes the exchange
/// symmetric, so that sum m c_p T is kept. The free surface comes in implicitly, so that it is stable for any area and
/// heat capacity. What a vent drives keeps its heat. Returns what passed through the surface and the walls.
template <int Dim, typename Real>
HeatLedger Solver<Dim, Real>::advance_heat(std::size_t i, double conducted, double dt, double time) {
  const Material& m = material(i);
  const HeatProperties& heat = *m.heat;
  HeatLedger passed;
  if (is_driven(i)) return passed;
  if (!terms_.ledger) {
    particles_.temperature[i] += dt * heat.diffusivity * m.density / particles_.density[i] * conducted;
    return passed;
  }
  const double per_rate = dt * conductivity(m) / particles_.density[i];  // of specific enthalpy
  if (const WallNeighbour<Dim>* wall = walls_ ? walls_->of(i) : nullptr)
    passed.to_walls = -mass(i) * per_rate * wall_heat<Dim>(*wall, colliders_, particles_.temperature[i]) /
                      heat_balance_[i].moment_trace;

  const double before =
      terms_.latent_heat ? particles_.enthalpy[i] : heat.specific_heat * (particles_.temperature[i] - heat.cold);
  double after = before + per_rate * conducted;
  if (terms_.exchange && free_surface_area_[i] > 0.0) after = exchange_heat(i, dt, time, after, passed);
  if (terms_.latent_heat) {
    particles_.enthalpy[i] = after;
    particles_.temperature[i] = temperature_at_enthalpy(heat, after);
  } else {
    particles_.temperature[i] += (after - before) / heat.specific_heat;
  }
  return passed;
}

/// Exchange with ambient and sources, on top of what conduction alone would leave, `target` [J/kg]. The particle's
/// centre is half a spacing below the surface, which is colder (or hotter) by what it takes to conduct the heat that
/// far.
template <int Dim, typename Real>
double Solver<Dim, Real>::exchange_heat(std::size_t i, double dt, double time, double target,
                                        HeatLedger& passed) const {
  const Material& m = material(i);
  const HeatProperties& heat = *m.heat;
  const SurfaceExchange exchange = surface_exchange(i, time);
  const double depth = 0.5 * spacing_;
  const double resistance = conductivity(m) > 0.0 ? depth / conductivity(m) : 0.0;
  const auto temperature_of = [&](double h) {
    return terms_.latent_heat ? temperature_at_enthalpy(heat, h) : heat.cold + h / heat.specific_heat;
  };
  const auto slope_of = [&](double h) {
    return terms_.latent_heat ? temperature_slope(heat, h) : 1.0 / heat.specific_heat;
  };
  const double area_dt = dt * free_surface_area_[i];
  const double after = exchange_enthalpy(exchange, resistance, area_dt / mass(i), target, temperature_of, slope_of);
  const double t = surface_temperature(exchange, resistance, temperature_of(after));
  passed.convected = area_dt * exchange.convected(t);
  passed.radiated = area_dt * exchange.radiated(t);
  passed.from_sources = area_dt * exchange.from_sources(t);
  return after;
}

template <int Dim, typename Real>
SurfaceExchange Solver<Dim, Real>::surface_exchange(std::size_t i, double time) const {
  SurfaceExchange exchange;
  if (parameters_.ambient) {
    exchange.convection = parameters_.ambient->heat_transfer;
    exchange.ambient = parameters_.ambient->temperature;
    exchange.emissivity = material(i).heat->emissivity;
  }
  for (std::size_t k = 0; k < parameters_.heat_sources.size(); ++k) {
    const HeatSource<Dim>& source = parameters_.heat_sources[k];
    if (!source.burns_at(time)) continue;
    const double weight = source.weight_at(particles_.position[i], time);
    if (weight == 0.0) continue;
    if (source.power) {
      exchange.source_input += weight * power_density_[k];
    } else {
      exchange.source_conductance += weight * source.heat_transfer;
      exchange.source_input += weight * source.heat_transfer * source.temperature;
    }
  }
  return exchange;
}

template class Solver<3, float>;
template class Solver<3, double>;
template class Solver<2, double>;
template class Solver<1, double>;

}  // namespace smelt
