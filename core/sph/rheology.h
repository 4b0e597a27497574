#pragma once
// The Souza Mendes-Dutra flow curve.

#include "core/sph/material.h"

#include <limits>

namespace smelt {

/// The SMD law at one temperature.
struct FlowCurve {
  double yield_stress = 0.0;    ///< tau0 [Pa]
  double consistency = 1.0;     ///< K [Pa s^n]
  double index = 1.0;           ///< n
  double rest_viscosity = 0.0;  ///< eta0 [Pa s]; infinite where tau0 = 0 and n < 1
};

/// u of [P 6-3], clamped to [0, 1]: outside its range the text's line would extrapolate to a negative J.
double melted_fraction(const HeatProperties& heat, double temperature);

/// A property at melted fraction `u` and `temperature` [K]; each law reads the one that it follows.
double value_at(const ThermalRange& property, double u, double temperature);

/// Whether a property is 0 at every temperature.
bool is_zero(const ThermalRange& property);

/// The law's parameters at melted fraction `u` and `temperature` [K], which only tables and exponentials need; eta0
/// from J where J is given.
FlowCurve flow_curve_at(const Rheology& rheology, double u,
                        double temperature = std::numeric_limits<double>::quiet_NaN());

/// tau(gdot) = eta(gdot) gdot [Pa] for gdot >= 0 [1/s].
double shear_stress(const FlowCurve& curve, double shear_rate);

/// eta(gdot) [Pa s]; tends to eta0 as gdot -> 0, without a division by zero.
double viscosity(const FlowCurve& curve, double shear_rate);

}  // namespace smelt
