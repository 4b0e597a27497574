#pragma once
// Equations of state: pressure and sound speed from density, and in a gas from internal energy.
//
// c is the sound speed at rest [m/s], rho0 the density at rest and rho the density [kg/m^3], e the specific internal
// energy [J/kg].

#include "core/error.h"

#include <cmath>

namespace smelt {

enum class PressureLaw { linear, tait, ideal_gas };

struct EquationOfState {
  PressureLaw law = PressureLaw::linear;
  /// Added to the pressure of `linear` and `tait` [Pa]. A constant has no gradient, but its sum over particles has one,
  /// towards even spacing: for flows without a free surface, which it would blow apart. An ideal gas has none.
  double background_pressure = 0.0;
  double adiabatic_index = 1.4;  ///< gamma of an ideal gas, > 1
};

/// p = c^2 (rho - rho0) [Pa]  [P 4-41].
inline double linear_pressure(double c, double rho0, double rho) {
  return c * c * (rho - rho0);
}

/// p = B ((rho/rho0)^7 - 1), B = c^2 rho0/7 [Pa]: as stiff as the linear law at rho0, stiffer above it  [S 4.32].
inline double tait_pressure(double c, double rho0, double rho) {
  const double s = rho / rho0, s3 = s * s * s;
  return c * c * rho0 / 7.0 * (s3 * s3 * s - 1.0);
}

/// p = (gamma - 1) rho e [Pa]  [S 4.30].
inline double ideal_gas_pressure(double gamma, double rho, double e) {
  return (gamma - 1.0) * rho * e;
}

/// Pressure [Pa]. `e` serves an ideal gas alone, `c` and `rho0` the others.
inline double compute_pressure(const EquationOfState& state, double c, double rho0, double rho, double e) {
  switch (state.law) {
    case PressureLaw::linear:
      return linear_pressure(c, rho0, rho) + state.background_pressure;
    case PressureLaw::tait:
      return tait_pressure(c, rho0, rho) + state.background_pressure;
    case PressureLaw::ideal_gas:
      return ideal_gas_pressure(state.adiabatic_index, rho, e);
  }
  throw InternalError("compute_pressure: unknown law");
}

/// sqrt(dp/drho) [m/s], at constant entropy: c; c (rho/rho0)^3; sqrt(gamma p/rho).
inline double compute_sound_speed(const EquationOfState& state, double c, double rho0, double rho, double e) {
  const double s = rho / rho0;
  switch (state.law) {
    case PressureLaw::linear:
      return c;
    case PressureLaw::tait:
      return c * s * s * s;
    case PressureLaw::ideal_gas:
      return std::sqrt(state.adiabatic_index * (state.adiabatic_index - 1.0) * e);
  }
  throw InternalError("compute_sound_speed: unknown law");
}

}  // namespace smelt
