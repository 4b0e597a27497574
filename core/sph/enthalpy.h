#pragma once
// Enthalpy and temperature of a material that takes up latent heat as it melts (the enthalpy method
// [Voller & Cross 1981]).

#include "core/sph/material.h"

namespace smelt {

/// Specific enthalpy H [J/kg] at temperature T [K], counted from the solid at cold_K:
///   c_p (T - cold) + u L,  u = clamp((T - cold)/(hot - cold), 0, 1);
/// at a sharp melting point (hot = cold) that of the solid.
double enthalpy_at(const HeatProperties& heat, double temperature);

/// The temperature [K] that belongs to it: constant over L where the melting point is sharp.
double temperature_at_enthalpy(const HeatProperties& heat, double enthalpy);

/// dT/dH [K kg/J]; 0 on a sharp melting point.
double temperature_slope(const HeatProperties& heat, double enthalpy);

/// The melted fraction u in [0, 1] that belongs to it.
double melted_fraction_at_enthalpy(const HeatProperties& heat, double enthalpy);

}  // namespace smelt
