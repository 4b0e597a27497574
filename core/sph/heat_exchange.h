#pragma once
// Heat that passes through the free surface: convection, radiation, and sources such as a flame.

#include "core/geometry/vec.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace smelt {

inline constexpr double stefan_boltzmann = 5.670374419e-8;  ///< sigma [W/(m^2 K^4)]

/// What the free surface loses heat to.
struct Ambient {
  double temperature = 0.0;    ///< T_a [K]
  double heat_transfer = 0.0;  ///< h of convection [W/(m^2 K)]
};

/// A place that heats the free surface near it, with the weight w = (1 - r^2/R^2)^2 at a distance r below R. Either
/// `power`, shared over the surface by weight and area (none where there is no surface within R), or the gas of a
/// flame: w h (T_source - T) a square metre.
template <int Dim>
struct HeatSource {
  Vec<Dim> position = Vec<Dim>::Zero();  ///< at the start [m]
  Vec<Dim> velocity = Vec<Dim>::Zero();  ///< [m/s]
  double radius = 0.0;                   ///< R [m]
  std::optional<double> power =
      std::nullopt;            ///< [W], W/m^(3 - Dim) in fewer dimensions; absent: a gas of given temperature
  double temperature = 0.0;    ///< [K]
  double heat_transfer = 0.0;  ///< h [W/(m^2 K)]
  double begin = 0.0;          ///< it burns from here on [s]
  double end = std::numeric_limits<double>::infinity();  ///< until here [s]

  bool burns_at(double time) const { return time >= begin && time < end; }
  double weight_at(const Vec<Dim>& place, double time) const {
    const double q2 = (place - position - time * velocity).squaredNorm() / (radius * radius);
    const double w = std::max(0.0, 1.0 - q2);
    return w * w;
  }
};

/// The exchange of one square metre of surface at temperature T_s, everything summed up [W/m^2]:
///   convection h (T_s - T_a), radiation e sigma (T_s^4 - T_a^4), sources G T_s - I.
struct SurfaceExchange {
  double convection = 0.0;          ///< h [W/(m^2 K)]
  double emissivity = 0.0;          ///< e
  double ambient = 0.0;             ///< T_a [K]
  double source_conductance = 0.0;  ///< G: sum of w h over the sources with a temperature [W/(m^2 K)]
  double source_input = 0.0;        ///< I: sum of w h T_source, and what sources of given power bring [W/m^2]

  double convected(double t) const { return convection * (t - ambient); }
  double radiated(double t) const {
    return emissivity * stefan_boltzmann * (signed_fourth(t) - signed_fourth(ambient));
  }
  double from_sources(double t) const { return source_input - source_conductance * t; }
  /// Outward, all together.
  double loss(double t) const { return convected(t) + radiated(t) - from_sources(t); }
  double loss_slope(double t) const {
    return convection + source_conductance + 4.0 * emissivity * stefan_boltzmann * t * t * (t < 0.0 ? -t : t);
  }

 private:
  /// Grows with t everywhere, so that every balance has one root.
  static double signed_fourth(double t) { return t < 0.0 ? -t * t * t * t : t * t * t * t; }
};

/// Energies that passed since the last Solver::prepare() [J] (J/m^(3 - Dim) in fewer dimensions): away by radiation and
/// convection at the free surface, away through walls of given temperature, and in from sources. What comes in and goes
/// out with particles is not among them.
struct HeatLedger {
  double radiated = 0.0;
  double convected = 0.0;
  double to_walls = 0.0;
  double from_sources = 0.0;

  HeatLedger& operator+=(const HeatLedger& other) {
    radiated += other.radiated;
    convected += other.convected;
    to_walls += other.to_walls;
    from_sources += other.from_sources;
    return *this;
  }
};

/// The temperature T_s of a surface that the centre of a particle, at `temperature` [K], feeds through `resistance`
/// [m^2 K/W]:
///   T_s + resistance * loss(T_s) = temperature.
double surface_temperature(const SurfaceExchange& exchange, double resistance, double temperature);

/// Backward Euler over a step: the specific enthalpy H [J/kg] with
///   H + share * loss(T_s) = target,   share = dt A/m [m^2 s/kg],
/// where T_s belongs to the temperature `temperature_of(H)`, which grows with H at `slope_of(H)`. Unique and stable for
/// any share: the loss grows with H. To 1e-13 of the change, or rounding.
template <typename TemperatureOf, typename SlopeOf>
double exchange_enthalpy(const SurfaceExchange& exchange, double resistance, double share, double target,
                         const TemperatureOf& temperature_of, const SlopeOf& slope_of) {
  const auto loss_at = [&](double h) {
    return exchange.loss(surface_temperature(exchange, resistance, temperature_of(h)));
  };
  const double full = share * loss_at(target);
  if (full == 0.0) return target;
  // The loss shrinks on the way from the target, so the root lies before target - full.
  double lower = std::min(target, target - full), upper = std::max(target, target - full);
  double h = target;
  for (int iteration = 0; iteration < 100; ++iteration) {
    const double t_s = surface_temperature(exchange, resistance, temperature_of(h));
    const double residual = h + share * exchange.loss(t_s) - target;
    if (std::abs(residual) <= 1e-13 * std::abs(full) + 1e-15 * std::abs(target)) return h;
    (residual > 0.0 ? upper : lower) = h;
    const double per_surface = exchange.loss_slope(t_s);
    const double slope = 1.0 + share * per_surface / (1.0 + resistance * per_surface) * slope_of(h);
    const double newton = h - residual / slope;
    // Corners of T(H) throw Newton to and fro.
    h = newton > lower && newton < upper && iteration % 8 != 7 ? newton : 0.5 * (lower + upper);
    if (!(h > lower && h < upper)) return h;
  }
  return h;
}

}  // namespace smelt
