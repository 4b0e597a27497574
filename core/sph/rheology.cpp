#include "core/sph/rheology.h"

#include "core/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace smelt {

namespace {

/// gdot^n, with the square root that most viscoplastic scenes use ([P 6.1]: n = 1/2) kept fast.
double power(double shear_rate, double index) {
  if (index == 1.0) return shear_rate;
  if (index == 0.5) return std::sqrt(shear_rate);
  if (index == 2.0) return shear_rate * shear_rate;
  return std::pow(shear_rate, index);
}

/// Through the points of a table, the logarithm where there is one.
double table_value(const ThermalRange& table, double temperature) {
  if (std::isnan(temperature)) return temperature;
  const auto above = std::upper_bound(table.temperature.begin(), table.temperature.end(), temperature);
  if (above == table.temperature.begin()) return table.value.front();
  if (above == table.temperature.end()) return table.value.back();
  const auto k = static_cast<std::size_t>(above - table.temperature.begin());
  const double before = table.value[k - 1], after = table.value[k];
  const double w = (temperature - table.temperature[k - 1]) / (table.temperature[k] - table.temperature[k - 1]);
  if (before > 0.0 && after > 0.0) return before * std::pow(after / before, w);
  return (1.0 - w) * before + w * after;
}

}  // namespace

double value_at(const ThermalRange& property, double u, double temperature) {
  switch (property.law) {
    case ThermalLaw::range:
      return (1.0 - u) * property.cold + u * property.hot;
    case ThermalLaw::table:
      return table_value(property, temperature);
    case ThermalLaw::exponential:
      return property.reference *
             std::exp(-property.rate *
                      (std::clamp(temperature, property.coldest, property.hottest) - property.reference_temperature));
  }
  throw InternalError("value_at: unknown law");
}

bool is_zero(const ThermalRange& property) {
  switch (property.law) {
    case ThermalLaw::range:
      return property.cold == 0.0 && property.hot == 0.0;
    case ThermalLaw::table:
      return std::all_of(property.value.begin(), property.value.end(), [](double v) { return v == 0.0; });
    case ThermalLaw::exponential:
      return property.reference == 0.0;
  }
  throw InternalError("is_zero: unknown law");
}

double melted_fraction(const HeatProperties& heat, double temperature) {
  return std::clamp((temperature - heat.cold) / (heat.hot - heat.cold), 0.0, 1.0);
}

FlowCurve flow_curve_at(const Rheology& rheology, double u, double temperature) {
  FlowCurve curve;
  curve.yield_stress = value_at(rheology.yield_stress, u, temperature);
  curve.consistency = value_at(rheology.consistency, u, temperature);
  curve.index = rheology.index;
  if (curve.yield_stress == 0.0) {
    curve.rest_viscosity = curve.index == 1.0 ? curve.consistency : std::numeric_limits<double>::infinity();
  } else if (rheology.rest_viscosity) {
    curve.rest_viscosity = value_at(*rheology.rest_viscosity, u, temperature);
  } else {
    CHECK(rheology.jump_number.has_value());
    const double gdot1 = power(curve.yield_stress / curve.consistency, 1.0 / curve.index);
    curve.rest_viscosity = (value_at(*rheology.jump_number, u, temperature) + 1.0) * curve.yield_stress / gdot1;
  }
  return curve;
}

double shear_stress(const FlowCurve& curve, double shear_rate) {
  if (!(shear_rate > 0.0)) return 0.0;
  const double plastic = curve.yield_stress + curve.consistency * power(shear_rate, curve.index);
  if (curve.yield_stress == 0.0) return plastic;
  return -std::expm1(-curve.rest_viscosity / curve.yield_stress * shear_rate) * plastic;
}

double viscosity(const FlowCurve& curve, double shear_rate) {
  // Below this rate tau/gdot loses digits and eta differs from eta0 by less than they are worth.
  const double a = curve.yield_stress > 0.0 ? curve.rest_viscosity / curve.yield_stress : 0.0;
  if (shear_rate <= 0.0 || a * shear_rate < 1e-12) {
    if (curve.yield_stress > 0.0 || shear_rate <= 0.0) return curve.rest_viscosity;
  }
  return shear_stress(curve, shear_rate) / shear_rate;
}

}  // namespace smelt
