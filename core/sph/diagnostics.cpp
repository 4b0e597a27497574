#include "core/sph/diagnostics.h"

#include "core/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace smelt {

template <int Dim, typename Real>
Diagnostics<Dim> compute_diagnostics(const Solver<Dim, Real>& solver) {
  const Particles<Dim>& p = solver.particles();
  const bool thermal = !p.temperature.empty();
  Diagnostics<Dim> none;
  none.min_temperature = std::numeric_limits<double>::infinity();
  Diagnostics<Dim> d = deterministic_reduce(
      p.size(), none,
      [&](std::size_t i) {
        const double m = solver.mass(i);
        const double density_error = std::abs(p.density[i] / solver.material(i).density - 1.0);
        Diagnostics<Dim> one;
        one.n_particles = 1;
        one.mass = m;
        one.momentum = m * p.velocity[i];
        one.kinetic_energy = 0.5 * m * p.velocity[i].squaredNorm();
        one.potential_energy = -m * solver.parameters().gravity.dot(p.position[i]);
        one.mean_density_error = density_error;
        one.max_density_error = density_error;
        one.max_speed = p.velocity[i].norm();
        if (thermal) one.min_temperature = one.max_temperature = p.temperature[i];
        if (solver.knows_enthalpy()) one.enthalpy = m * solver.enthalpy(i);
        return one;
      },
      [](Diagnostics<Dim> a, const Diagnostics<Dim>& b) {
        a.n_particles += b.n_particles;
        a.mass += b.mass;
        a.momentum += b.momentum;
        a.kinetic_energy += b.kinetic_energy;
        a.potential_energy += b.potential_energy;
        a.mean_density_error += b.mean_density_error;
        a.max_density_error = std::max(a.max_density_error, b.max_density_error);
        a.max_speed = std::max(a.max_speed, b.max_speed);
        a.min_temperature = std::min(a.min_temperature, b.min_temperature);
        a.max_temperature = std::max(a.max_temperature, b.max_temperature);
        a.enthalpy += b.enthalpy;
        return a;
      });
  d.mean_density_error /= static_cast<double>(std::max<std::size_t>(1, p.size()));
  if (!thermal || p.size() == 0) d.min_temperature = 0.0;
  return d;
}

template Diagnostics<3> compute_diagnostics(const Solver<3, float>&);
template Diagnostics<3> compute_diagnostics(const Solver<3, double>&);
template Diagnostics<2> compute_diagnostics(const Solver<2, double>&);
template Diagnostics<1> compute_diagnostics(const Solver<1, double>&);

}  // namespace smelt
