#include "core/sph/enthalpy.h"

#include <algorithm>

namespace smelt {

namespace {

/// From the solid at cold_K to the liquid at hot_K [J/kg].
double melting_enthalpy(const HeatProperties& heat) {
  return heat.specific_heat * (heat.hot - heat.cold) + heat.latent_heat;
}

}  // namespace

double enthalpy_at(const HeatProperties& heat, double temperature) {
  const double sensible = heat.specific_heat * (temperature - heat.cold);
  if (temperature <= heat.cold) return sensible;
  if (temperature >= heat.hot) return sensible + heat.latent_heat;
  return sensible + heat.latent_heat * (temperature - heat.cold) / (heat.hot - heat.cold);
}

double temperature_at_enthalpy(const HeatProperties& heat, double enthalpy) {
  const double melting = melting_enthalpy(heat);
  if (enthalpy <= 0.0) return heat.cold + enthalpy / heat.specific_heat;
  if (enthalpy >= melting) return heat.hot + (enthalpy - melting) / heat.specific_heat;
  return heat.cold + (heat.hot - heat.cold) * enthalpy / melting;
}

double temperature_slope(const HeatProperties& heat, double enthalpy) {
  const double melting = melting_enthalpy(heat);
  return enthalpy <= 0.0 || enthalpy >= melting ? 1.0 / heat.specific_heat : (heat.hot - heat.cold) / melting;
}

double melted_fraction_at_enthalpy(const HeatProperties& heat, double enthalpy) {
  return std::clamp(enthalpy / melting_enthalpy(heat), 0.0, 1.0);
}

}  // namespace smelt
