#pragma once
// Sums and extremes that tell whether a simulation is healthy.

#include "core/sph/solver.h"

namespace smelt {

template <int Dim>
struct Diagnostics {
  std::size_t n_particles = 0;
  double mass = 0.0;                     ///< [kg]
  Vec<Dim> momentum = Vec<Dim>::Zero();  ///< [kg m/s]
  double kinetic_energy = 0.0;           ///< [J]
  double potential_energy = 0.0;         ///< -sum m g.x [J]
  double mean_density_error = 0.0;       ///< mean of |rho/rho0 - 1|
  double max_density_error = 0.0;
  double max_speed = 0.0;        ///< [m/s]
  double min_temperature = 0.0;  ///< [K]; 0 in a scene without heat
  double max_temperature = 0.0;
  double enthalpy = 0.0;  ///< from the solid at cold_K on [J]; 0 where no specific heat is known
};

/// Sums run in an order that depends on the number of particles only.
template <int Dim, typename Real>
Diagnostics<Dim> compute_diagnostics(const Solver<Dim, Real>& solver);

}  // namespace smelt
