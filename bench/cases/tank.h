#pragma once
// Water in open tanks: walls, levels, and the pressure that a gauge in a wall would show.

#include "bench/cases/set_up.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace smelt {

constexpr double water_density = 1000.0;  ///< [kg/m^3]
constexpr double gravity = 9.81;          ///< [m/s^2]

/// A solid wall along `corners` [m] in order, with the fluid on the right hand of one who walks along them. Free
/// slip: what touches it keeps its speed along it.
inline Obstacle<2> make_wall(const std::vector<Vec<2>>& corners) {
  Obstacle<2> wall;
  wall.wall = true;
  wall.closed = true;
  wall.response.friction = 1.0;
  for (std::size_t i = 1; i < corners.size(); ++i) wall.facets.push_back({corners[i - 1], corners[i]});
  return wall;
}

inline Colliders<2> make_colliders(const std::vector<std::vector<Vec<2>>>& walls) {
  Colliders<2> colliders;
  for (const auto& corners : walls) colliders.add(make_wall(corners));
  return colliders;
}

/// Water `depth` [m] deep of particles `spacing` [m] apart: c ten times the speed sqrt(2 g depth) that it can fall to,
/// and a tenth of density diffusion, so that pressure stays smooth.
inline SolverParameters<2> make_water_parameters(double spacing, double depth, double artificial_viscosity) {
  auto parameters = make_parameters<2>(spacing, 10.0 * std::sqrt(2.0 * gravity * depth));
  parameters.smoothing_length = 1.3 * spacing;
  parameters.gravity = Vec<2>(0.0, -gravity);
  parameters.artificial_viscosity = artificial_viscosity;
  parameters.density_diffusion = 0.1;
  parameters.courant = 0.4;
  return parameters;
}

/// Density [kg/m^3] at which the linear or Tait law gives the pressure p [Pa]; Tait's is [S 4.52].
inline double density_at_pressure(PressureLaw law, double c, double p) {
  const double s = p / (c * c * water_density);
  return water_density * (law == PressureLaw::tait ? std::pow(1.0 + 7.0 * s, 1.0 / 7.0) : 1.0 + s);
}

/// The pressure's excess [Pa] over that of water at rest under `level` [m] (measured against gravity), as a gauge at
/// `point` shows it: the mean over the particles within the kernel's support, with its weights. NaN where there are
/// none.
inline double gauge_excess(const Solver<2, double>& solver, double level, const Vec<2>& point) {
  const auto& p = solver.particles();
  const auto& parameters = solver.parameters();
  const Vec<2> up = -parameters.gravity.normalized();
  const double reach = 2.0 * parameters.smoothing_length;
  double sum = 0.0, weights = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double q = (p.position[i] - point).norm() / reach;
    if (q >= 1.0) continue;
    const double weight = std::pow(1.0 - q, 4) * (1.0 + 4.0 * q);
    const double pressure =
        compute_pressure(parameters.equation_of_state, parameters.sound_speed, water_density, p.density[i], 0.0);
    sum += weight * (pressure - water_density * parameters.gravity.norm() * (level - p.position[i].dot(up)));
    weights += weight;
  }
  return weights > 0.0 ? sum / weights : std::numeric_limits<double>::quiet_NaN();
}

/// Farthest that a particle's centre is behind a wall's plane within reach of it [m]; 0 where none is. Corners must be
/// convex fluid.
inline double deepest_in_wall(const Solver<2, double>& solver, const std::vector<std::vector<Vec<2>>>& walls) {
  double deepest = 0.0;
  for (const auto& corners : walls)
    for (std::size_t k = 1; k < corners.size(); ++k) {
      const Vec<2> along = (corners[k] - corners[k - 1]).normalized();
      const Vec<2> normal(along[1], -along[0]);
      for (const Vec<2>& x : solver.particles().position) deepest = std::max(deepest, -(x - corners[k]).dot(normal));
    }
  return deepest;
}

}  // namespace smelt
