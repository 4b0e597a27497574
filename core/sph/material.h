#pragma once
// What a fluid is made of: density, flow curve and heat, each with its dependence on temperature.

#include <optional>
#include <string>

namespace smelt {

/// A property that runs linearly from its cold to its hot value over the melting range  [P 6-3].
struct ThermalRange {
  double cold = 0.0;
  double hot = 0.0;
  /// `u` in [0, 1]: 0 at and below cold_K, 1 at and above hot_K.
  double at(double u) const { return (1.0 - u) * cold + u * hot; }
};

/// Souza Mendes-Dutra viscoplastic law  [P 6-1, de Souza Mendes & Dutra 2004]:
///   eta(gdot) = (1 - exp(-eta0 gdot / tau0)) (tau0/gdot + K gdot^(n-1)).
/// The viscosity at rest eta0 is given, or follows from the jump number J = eta0 gdot1 / tau0 - 1, gdot1 = (tau0/K)^(1/n).
/// tau0 = 0 is a power-law fluid; tau0 = 0 and n = 1 is Newtonian.
struct Rheology {
  ThermalRange yield_stress;                   ///< tau0 [Pa]
  ThermalRange consistency{1.0, 1.0};          ///< K [Pa s^n]
  double index = 1.0;                          ///< n, in (0, 1]
  std::optional<ThermalRange> jump_number;     ///< J [-]
  std::optional<ThermalRange> rest_viscosity;  ///< eta0 [Pa s]
};

/// Conduction and the melting range. `cold` and `hot` bound the range over which the rheology changes.
struct HeatProperties {
  double diffusivity = 0.0;  ///< k [m^2/s]
  double cold = 0.0;         ///< [K]
  double hot = 0.0;          ///< [K], > cold
};

struct Material {
  std::string name;
  double density = 1000.0;  ///< at rest, rho0 [kg/m^3]
  Rheology rheology;
  std::optional<HeatProperties> heat;  ///< absent: nothing thermal exists
};

}  // namespace smelt
