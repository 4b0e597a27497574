#include "core/sph/heat_exchange.h"

#include <cmath>

namespace smelt {

double surface_temperature(const SurfaceExchange& exchange, double resistance, double temperature) {
  if (resistance == 0.0) return temperature;
  // The left side is convex above 0 K: after one step Newton comes down to the root from above.
  double t = temperature;
  for (int iteration = 0; iteration < 60; ++iteration) {
    const double residual = t + resistance * exchange.loss(t) - temperature;
    const double step = residual / (1.0 + resistance * exchange.loss_slope(t));
    t -= step;
    if (std::abs(step) <= 1e-14 * std::abs(t)) return t;
  }
  return t;
}

}  // namespace smelt
