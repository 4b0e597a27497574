#pragma once
// What walls add to the sums over neighbour pairs of one particle (symbols as in core/sph/walls.h, formulation in
// docs/decisions/0008-walls.md).

#include "core/sph/gradient_correction.h"
#include "core/sph/pressure_sums.h"
#include "core/sph/walls.h"

namespace smelt {

/// The part of a velocity (or traction) that a wall holds: all of it across the wall; along it, the share that does not
/// slip (`friction` of the response, 0: no slip, 1: free slip).
template <int Dim>
Vec<Dim> held_by_wall(const Vec<Dim>& vector, const Vec<Dim>& normal, const ContactResponse& response) {
  const double slip = response.friction;
  return (1.0 - slip) * vector + slip * vector.dot(normal) * normal;
}

/// A share of the density at rest far below what sound makes of it (1 % at a Mach number of 0.1): fluid this thin has
/// come off the wall. A lone particle that leaves would lose all of its density to the mirrored velocity, which grows
/// with 1/d.
inline constexpr double cavitation_density = 0.97;

/// - 2 sum (T - T_wall) A/d over the contacts with walls of given temperature (T_w - T = (T - T_wall) (n.y)/d in the
///   solid) [K/m^2].
template <int Dim>
double wall_heat(const WallNeighbour<Dim>& wall, const Colliders<Dim>& colliders, double temperature) {
  double heat = 0.0;
  for (const WallContact<Dim>& contact : wall.contacts)
    if (const auto& of_wall = colliders.placed()[contact.obstacle].obstacle.temperature)
      heat -= 2.0 * (temperature - *of_wall) * contact.conductance;
  return heat;
}

/// Adds to the rate sums of a particle with velocity `v`, density `rho` and temperature `T`, P standing for
/// held_by_wall:
///   density_rate     - rho sum push (v - u).n                     (the velocity across is mirrored; a wall does not
///   draw
///                                                                  fluid out below cavitation_density rho0)
///   velocity_moment  + sum stretch P (v - u) (x) n                (v_w - v = P (v - u) (n.y)/d in the solid, and
///                    + sum (1 - slip) Omega (Gamma I - first (x) n)      (1 - slip) Omega y: what turns with the wall
///                    is not sheared)
///   position_moment  + int y (x) grad_w dV
///   heat             + wall_heat / theta,
///   moment_trace     + tr int y (x) grad_w dV / Dim, and
///   heat_imbalance   - sum A n, of walls with a temperature alone: at others support is missing,
/// with theta [-] the particle's moment trace of the pass before. Both moments are added to `sighted`, if given, as
/// well: every stress sees a wall.
template <int Dim, typename Real>
void accumulate_wall_rates(const WallNeighbour<Dim>& wall, const Colliders<Dim>& colliders, const PairTerms& terms,
                           const Vec<Dim>& v, double rho, double rest_density, double temperature, double theta,
                           RateSums<Dim, Real>& sums, SightedSums<Dim, Real>* sighted = nullptr) {
  double density_rate = 0.0, solid = 0.0, conducting = 0.0;
  Mat<Dim> velocity_moment = Mat<Dim>::Zero();
  for (const WallContact<Dim>& contact : wall.contacts) {
    const PlacedObstacle<Dim>& placed = colliders.placed()[contact.obstacle];
    const Obstacle<Dim>& obstacle = placed.obstacle;
    const Vec<Dim> relative = v - contact.velocity;
    const double leaving = relative.dot(contact.normal);
    if (leaving < 0.0 || rho > cavitation_density * rest_density) density_rate -= rho * contact.push * leaving;
    velocity_moment +=
        contact.stretch * held_by_wall<Dim>(relative, contact.normal, obstacle.response) * contact.normal.transpose();
    if (!placed.twist.spin.isZero(0.0)) {
      const Mat<Dim> moment = contact.solid * Mat<Dim>::Identity() - contact.first * contact.normal.transpose();
      velocity_moment += (1.0 - obstacle.response.friction) * placed.twist.spin * moment;
    }
    solid += contact.solid;
    if (!terms.has_heat() || !obstacle.temperature) continue;
    conducting += contact.solid;
    for (int a = 0; a < Dim; ++a) sums.heat_imbalance[a] -= static_cast<Real>(contact.area * contact.normal[a]);
  }
  sums.density_rate += static_cast<Real>(density_rate);
  if (terms.has_heat()) sums.heat += static_cast<Real>(wall_heat<Dim>(wall, colliders, temperature) / theta);
  if (conducting > 0.0) sums.moment_trace += static_cast<Real>(conducting / solid * wall.moment.trace() / Dim);
  if (terms.stress)
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) {
        sums.velocity_moment[a * Dim + b] += static_cast<Real>(velocity_moment(a, b));
        if (sighted) sighted->velocity_moment[a * Dim + b] += static_cast<Real>(velocity_moment(a, b));
      }
  if (!terms.stress && !terms.has_heat()) return;
  const Symmetric<Dim> moment = to_symmetric<Dim>(wall.moment);
  for (int k = 0; k < n_symmetric<Dim>; ++k) sums.position_moment[k] += static_cast<Real>(moment[k]);
  if (!sighted) return;
  for (int k = 0; k < n_symmetric<Dim>; ++k) sighted->position_moment[k] += static_cast<Real>(moment[k]);
}

/// int (p_w - p) grad_w dV over the solid behind one plane [Pa/m], where the pressure goes on with the gradient `along`
/// [Pa/m] that it has along the wall and with rho (g - a_w) across it.
template <int Dim>
Vec<Dim> contact_pressure_moment(const WallContact<Dim>& contact, const Vec<Dim>& along, double rho,
                                 const Vec<Dim>& gravity) {
  const Vec<Dim> gradient =
      along + (rho * (gravity - contact.acceleration) - along).dot(contact.normal) * contact.normal;
  return contact.solid * gradient - contact.first.dot(gradient) * contact.normal;
}

/// The same over the whole solid.
template <int Dim>
Vec<Dim> wall_pressure_moment(const WallNeighbour<Dim>& wall, const Vec<Dim>& along, double rho,
                              const Vec<Dim>& gravity) {
  Vec<Dim> sum = Vec<Dim>::Zero();
  for (const WallContact<Dim>& contact : wall.contacts)
    sum += contact_pressure_moment<Dim>(contact, along, rho, gravity);
  return sum;
}

/// The corrected pressure gradient [Pa/m], exact for linear fields, that fluid and `wall` (or nullptr) give together.
/// The fluid alone says how the pressure changes along the wall.
template <int Dim, typename Real>
Vec<Dim> compute_pressure_gradient(const PressureGradientSums<Dim, Real>& sums, const WallNeighbour<Dim>* wall,
                                   double rho, const Vec<Dim>& gravity) {
  Vec<Dim> gradient;
  Symmetric<Dim> packed;
  for (int a = 0; a < Dim; ++a) gradient[a] = sums.gradient[a];
  for (int k = 0; k < n_symmetric<Dim>; ++k) packed[k] = sums.moment[k];
  const Mat<Dim> moment = to_matrix<Dim>(packed);
  const Vec<Dim> of_fluid = compute_gradient_correction<Dim>(moment) * gradient;
  if (!wall || wall->contacts.empty()) return of_fluid;
  return compute_gradient_correction<Dim>(moment + wall->moment) *
         (gradient + wall_pressure_moment<Dim>(*wall, of_fluid, rho, gravity));
}

/// Acceleration [m/s^2] by pressure p [Pa] and corrected extra stress S L [Pa] at one plane, P standing for
/// held_by_wall: the adjoints of the rates above, so that a wall takes just the power that the fluid at it is deformed
/// with, and the pressure's gradient in the solid,
///   1/rho [ push p n - stretch P S L n - int (p_w - p) grad_w dV ].
template <int Dim>
Vec<Dim> contact_acceleration(const WallContact<Dim>& contact, const ContactResponse& response, double rho,
                              double pressure, const Mat<Dim>& corrected_stress, const Vec<Dim>& pressure_gradient,
                              const Vec<Dim>& gravity) {
  const Vec<Dim>& n = contact.normal;
  const Vec<Dim> force = contact.push * pressure * n -
                         contact.stretch * held_by_wall<Dim>(corrected_stress * n, n, response) -
                         contact_pressure_moment<Dim>(contact, pressure_gradient, rho, gravity);
  return force / rho;
}

}  // namespace smelt
