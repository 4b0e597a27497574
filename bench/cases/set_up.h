#pragma once
// Fluids for cases and tests: lattices, discs and balls, and the loop that advances them.

#include "core/sph/solver.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace smelt {

/// A number in [-1, 1) that belongs to a lattice site and an axis: the same wherever the site is visited from
/// (splitmix64).
inline double site_noise(std::int64_t i, std::int64_t j, std::int64_t k, int axis) {
  std::uint64_t z = static_cast<std::uint64_t>(((i * 1000003 + j) * 1000003 + k) * 3 + axis) + 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) * 0x1.0p-52 - 1.0;
}

/// Adds one particle with the next id.
template <int Dim>
void add_particle(Particles<Dim>& particles, const Vec<Dim>& position, const Vec<Dim>& velocity, double density) {
  particles.id.push_back(static_cast<std::int32_t>(particles.id.size()));
  particles.position.push_back(position);
  particles.velocity.push_back(velocity);
  particles.density.push_back(density);
}

/// Particles at rest on the sites lower + (i + 1/2) spacing of the box that satisfy `inside(site)`, each moved by up to
/// `jitter` spacings along every axis. Lengths in metres, `density` in kg/m^Dim.
template <int Dim, typename Inside>
Particles<Dim> make_lattice(const Box<Dim>& box, double spacing, double density, double jitter, const Inside& inside) {
  std::array<std::int64_t, 3> n{1, 1, 1};
  for (int a = 0; a < Dim; ++a) n[a] = std::llround(box.extent()[a] / spacing);
  Particles<Dim> particles;
  for (std::int64_t k = 0; k < n[2]; ++k)
    for (std::int64_t j = 0; j < n[1]; ++j)
      for (std::int64_t i = 0; i < n[0]; ++i) {
        const std::array<std::int64_t, 3> index{i, j, k};
        Vec<Dim> site, noise;
        for (int a = 0; a < Dim; ++a) {
          site[a] = box.lower[a] + (static_cast<double>(index[a]) + 0.5) * spacing;
          noise[a] = jitter * spacing * site_noise(i, j, k, a);
        }
        if (inside(site)) add_particle<Dim>(particles, site + noise, Vec<Dim>::Zero(), density);
      }
  return particles;
}

/// A whole box of them.
template <int Dim>
Particles<Dim> make_block(const Box<Dim>& box, double spacing, double density, double jitter = 0.0) {
  return make_lattice<Dim>(box, spacing, density, jitter, [](const Vec<Dim>&) { return true; });
}

/// A segment, disc or ball about the origin.
template <int Dim>
Particles<Dim> make_ball(double radius, double spacing, double density, double jitter = 0.0) {
  const double reach = std::ceil(radius / spacing) * spacing;
  Box<Dim> box;
  box.lower = Vec<Dim>::Constant(-reach);
  box.upper = Vec<Dim>::Constant(reach);
  return make_lattice<Dim>(box, spacing, density, jitter, [&](const Vec<Dim>& x) { return x.norm() <= radius; });
}

/// Volume and smoothing length (1.2 spacings) of particles `spacing` [m] apart, and the sound speed [m/s]; nothing else
/// on.
template <int Dim>
SolverParameters<Dim> make_parameters(double spacing, double sound_speed) {
  SolverParameters<Dim> parameters;
  parameters.particle_volume = std::pow(spacing, Dim);
  parameters.smoothing_length = 1.2 * spacing;
  parameters.sound_speed = sound_speed;
  return parameters;
}

/// No stress but pressure. `density` in kg/m^3.
inline Material inviscid_material(double density) {
  Material m{"inviscid", density, {}, std::nullopt};
  m.rheology.consistency = {0.0, 0.0};
  return m;
}

/// Viscosity `viscosity` [Pa s] at every shear rate.
inline Material newtonian_material(double density, double viscosity) {
  Material m{"newtonian", density, {}, std::nullopt};
  m.rheology.consistency = {viscosity, viscosity};
  return m;
}

/// Souza Mendes-Dutra with yield stress [Pa], consistency [Pa s^index], index and jump number J.
inline Material viscoplastic_material(double density, double yield_stress, double consistency, double index,
                                      double jump) {
  Material m{"viscoplastic", density, {}, std::nullopt};
  m.rheology.yield_stress = {yield_stress, yield_stress};
  m.rheology.consistency = {consistency, consistency};
  m.rheology.index = index;
  m.rheology.jump_number = ThermalRange{jump, jump};
  return m;
}

/// Advances a prepared solver by `duration` [s] from `start` [s], which only serves messages. Returns the number of
/// steps.
template <int Dim, typename Real>
int advance_by(Solver<Dim, Real>& solver, double duration, double start = 0.0) {
  int n = 0;
  for (double remaining = duration; remaining > 0.0; ++n)
    remaining -= solver.step(remaining, start + duration - remaining).dt;
  return n;
}

}  // namespace smelt
