#pragma once
// Runs a scene and keeps the worst that was seen on the way.

#include "core/sph/solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace smelt {

/// Energy of compression of a liquid [J/kg]: int p/rho^2 drho from rho0; s = rho/rho0.
inline double compression_energy(PressureLaw law, double c, double s) {
  if (law == PressureLaw::tait) return c * c / 7.0 * (std::pow(s, 6) / 6.0 + 1.0 / s - 7.0 / 6.0);
  return c * c * (std::log(s) + 1.0 / s - 1.0);
}

/// Kinetic energy, -sum m g.x, compression and, where the stress is relaxed, its spring V S:S/(4 G) [J]: what no term
/// of the method may add to.
template <int Dim, typename Real>
double total_energy(const Solver<Dim, Real>& solver) {
  const Particles<Dim>& p = solver.particles();
  const SolverParameters<Dim>& parameters = solver.parameters();
  double energy = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double m = solver.mass(i), rho0 = solver.material(i).density;
    energy += 0.5 * m * p.velocity[i].squaredNorm() - m * parameters.gravity.dot(p.position[i]);
    energy += m * compression_energy(parameters.equation_of_state.law, parameters.sound_speed, p.density[i] / rho0);
    if (!p.stress.empty() && parameters.shear_wave_speed > 0.0) {
      const double modulus = rho0 * parameters.shear_wave_speed * parameters.shear_wave_speed;
      energy += m / p.density[i] * to_matrix<Dim>(p.stress[i]).squaredNorm() / (4.0 * modulus);
    }
  }
  return energy;
}

template <int Dim, typename Real>
double kinetic_energy(const Solver<Dim, Real>& solver) {
  double energy = 0.0;
  for (std::size_t i = 0; i < solver.particles().size(); ++i)
    energy += 0.5 * solver.mass(i) * solver.particles().velocity[i].squaredNorm();
  return energy;
}

/// The worst of a run.
struct Watched {
  double energy_gain = 0.0;    ///< largest rise of E above its lowest so far, over the kinetic energy at the start
  double density_error = 0.0;  ///< largest |rho/rho0 - 1| of any particle, at any time
  int steps = 0;
  double time = 0.0;  ///< [s] that passed
};

/// Advances a scene from rest density for `duration` [s], or `most_steps`. The solver itself throws where something is
/// not finite.
template <int Dim, typename Real>
Watched watch(Solver<Dim, Real>& solver, double duration, int most_steps = std::numeric_limits<int>::max()) {
  Watched seen;
  solver.prepare();
  double lowest = total_energy(solver);
  const double scale = kinetic_energy(solver);
  for (; seen.time < duration && seen.steps < most_steps; ++seen.steps) {
    seen.time += solver.step(duration - seen.time, seen.time).dt;
    const double energy = total_energy(solver), gain = (energy - lowest) / scale;
    lowest = std::min(lowest, energy);
    if (!std::isnan(seen.energy_gain) && !(gain <= seen.energy_gain)) seen.energy_gain = gain;  // a NaN stays one
    for (std::size_t i = 0; i < solver.particles().size(); ++i)
      seen.density_error =
          std::max(seen.density_error, std::abs(solver.particles().density[i] / solver.material(i).density - 1.0));
  }
  return seen;
}

}  // namespace smelt
