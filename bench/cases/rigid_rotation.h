#pragma once
// A free body of stiff viscoplastic material that spins: rigid motion makes no viscous force, and lasts.

#include "bench/cases/case.h"
#include "bench/cases/set_up.h"

#include <utility>

namespace smelt::rigid_rotation {

constexpr double density = 1000.0;    ///< [kg/m^3]
constexpr double spacing = 0.05;      ///< [m]
constexpr double sound_speed = 20.0;  ///< [m/s]

/// J = 1000, and a yield stress above what the spins of these tests pull.
inline Material stiff_material() {
  return viscoplastic_material(density, 2000.0, 500.0, 0.5, 1000.0);
}

/// A rotation about the third axis through the origin, where the body's centre stays; `rate` in 1/s.
template <int Dim>
Vec<Dim> spin_velocity(const Vec<Dim>& x, double rate) {
  Vec<Dim> v = Vec<Dim>::Zero();
  v[0] = -rate * x[1];
  v[1] = rate * x[0];
  return v;
}

/// [kg m^2/s], a power of the metre less in 2D.
template <int Dim>
double angular_momentum(const Solver<Dim, double>& solver) {
  double sum = 0.0;
  for (std::size_t i = 0; i < solver.particles().size(); ++i) {
    const auto &x = solver.particles().position[i], &v = solver.particles().velocity[i];
    sum += solver.mass(i) * (x[0] * v[1] - x[1] * v[0]);
  }
  return sum;
}

/// Angular momentum over moment of inertia [1/s].
template <int Dim>
double angular_velocity(const Solver<Dim, double>& solver) {
  double inertia = 0.0;
  for (std::size_t i = 0; i < solver.particles().size(); ++i)
    inertia += solver.mass(i) * solver.particles().position[i].template head<2>().squaredNorm();
  return angular_momentum<Dim>(solver) / inertia;
}

/// At which the rim, `radius` [m] from the origin, has 2 % of the speed of sound [1/s].
inline double rate_of(double radius) {
  return 0.02 * sound_speed / radius;
}

/// The particles with the relaxed stress, spinning at that rate.
template <int Dim>
Solver<Dim, double> make_spinning(Particles<Dim> particles, double radius) {
  for (std::size_t i = 0; i < particles.size(); ++i)
    particles.velocity[i] = spin_velocity<Dim>(particles.position[i], rate_of(radius));
  auto parameters = make_parameters<Dim>(spacing, sound_speed);
  parameters.shear_wave_speed = sound_speed;
  parameters.artificial_viscosity = 0.1;
  return {parameters, {stiff_material()}, {}, std::move(particles)};
}

Case make_case();

}  // namespace smelt::rigid_rotation
