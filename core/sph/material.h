#pragma once
// What a fluid is made of: density, flow curve and heat, each with its dependence on temperature.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace smelt {

/// How a property follows temperature.
enum class ThermalLaw : std::uint8_t {
  range,  ///< linearly in the melted fraction u from `cold` to `hot`  [P 6-3]
  table,  ///< through points; between two of them geometrically, linearly where one of them is 0; constant beyond the
          ///< ends
  exponential  ///< reference exp(-rate (T - reference_K)), as lava codes have it [Costa & Macedonio 2005], T kept
               ///< between coldest and hottest
};

/// A property that may follow temperature.
struct ThermalRange {
  double cold = 0.0;
  double hot = 0.0;
  ThermalLaw law = ThermalLaw::range;
  std::vector<double> temperature = {};  ///< of a table, rising [K]
  std::vector<double> value = {};        ///< of a table, one a temperature
  double reference = 0.0;                ///< of an exponential: the value at reference_temperature
  double reference_temperature = 0.0;    ///< [K]
  double rate = 0.0;                     ///< a [1/K]; above 0 the value falls as it gets hotter
  double coldest = 0.0, hottest = 0.0;   ///< [K], bounds of an exponential's T
};

/// Souza Mendes-Dutra viscoplastic law  [P 6-1, de Souza Mendes & Dutra 2004]:
///   eta(gdot) = (1 - exp(-eta0 gdot / tau0)) (tau0/gdot + K gdot^(n-1)).
/// The viscosity at rest eta0 is given, or follows from the jump number J = eta0 gdot1 / tau0 - 1, gdot1 =
/// (tau0/K)^(1/n). tau0 = 0 is a power-law fluid; tau0 = 0 and n = 1 is Newtonian.
struct Rheology {
  ThermalRange yield_stress;                   ///< tau0 [Pa]
  ThermalRange consistency{1.0, 1.0};          ///< K [Pa s^n]
  double index = 1.0;                          ///< n, in (0, 1]
  std::optional<ThermalRange> jump_number;     ///< J [-]
  std::optional<ThermalRange> rest_viscosity;  ///< eta0 [Pa s]
};

/// Conduction, melting and what the surface gives off. `cold` and `hot`, solidus and liquidus, bound the range over
/// which the rheology changes and latent heat is taken up, evenly.
struct HeatProperties {
  double diffusivity = 0.0;    ///< k = conductivity/(rho0 c_p) [m^2/s]
  double cold = 0.0;           ///< [K]
  double hot = 0.0;            ///< [K], > cold; with latent heat also = cold, a sharp melting point
  double specific_heat = 0.0;  ///< c_p [J/(kg K)]; 0: not known, and then neither is any energy
  double latent_heat = 0.0;    ///< L [J/kg]
  double emissivity = 0.0;     ///< of the free surface, 0 to 1
};

struct Material {
  std::string name;
  double density = 1000.0;  ///< at rest, rho0 [kg/m^3]
  Rheology rheology;
  std::optional<HeatProperties> heat;  ///< absent: nothing thermal exists
};

/// rho0 c_p k [W/(m K)] of a material with heat; over c_p where that is not known [kg/(m s)].
inline double conductivity(const Material& material) {
  const HeatProperties& heat = *material.heat;
  return material.density * heat.diffusivity * (heat.specific_heat > 0.0 ? heat.specific_heat : 1.0);
}

}  // namespace smelt
