#pragma once
// A rigid body: an obstacle of given mass that what it hits pushes back.
//
// Angular quantities are skew matrices as in core/geometry/pose.h: the angular momentum of a point mass is L = m (v x^T
// - x v^T), a torque F x^T - x F^T. With the second moment J = sum m x x^T of the body about its centre, L = Omega J +
// J Omega.

#include "core/geometry/mass_properties.h"
#include "core/geometry/pose.h"

namespace smelt {

/// What a step needs of a body from the one before.
template <int Dim>
struct BodyState {
  Vec<Dim> centre = Vec<Dim>::Zero();            ///< of mass [m]
  Mat<Dim> rotation = Mat<Dim>::Identity();      ///< from where it is at rest
  Vec<Dim> velocity = Vec<Dim>::Zero();          ///< of the centre [m/s]
  Mat<Dim> angular_momentum = Mat<Dim>::Zero();  ///< about the centre, skew [kg m^2/s]
};

/// Force and torque about the centre of mass.
template <int Dim>
struct Load {
  Vec<Dim> force = Vec<Dim>::Zero();   ///< [N]
  Mat<Dim> torque = Mat<Dim>::Zero();  ///< skew [N m]
};

template <int Dim>
struct RigidBody {
  double mass = 0.0;                        ///< [kg]
  Vec<Dim> rest_centre = Vec<Dim>::Zero();  ///< of mass, where the body is at rest [m]
  Mat<Dim> axes = Mat<Dim>::Identity();     ///< principal ones at rest, in columns
  Vec<Dim> moments = Vec<Dim>::Zero();      ///< eigenvalues of J [kg m^2]
  BodyState<Dim> state;
  Load<Dim> load;  ///< of the fluid, without gravity

  Pose<Dim> pose() const { return {state.rotation, state.centre - state.rotation * rest_centre}; }

  /// Omega of an angular momentum `l` (skew) at its present rotation [rad/s].
  Mat<Dim> spin_of(const Mat<Dim>& l) const;
  Mat<Dim> spin() const { return spin_of(state.angular_momentum); }

  Vec<Dim> velocity_at(const Vec<Dim>& x) const { return state.velocity + spin() * (x - state.centre); }

  /// Change of the velocity at x along the unit vector n by a unit impulse there along n [1/kg].
  double compliance(const Vec<Dim>& x, const Vec<Dim>& n) const;
  /// At least that, whatever the direction.
  double compliance_bound(const Vec<Dim>& x) const;

  /// An impulse [kg m/s] at x.
  void strike(const Vec<Dim>& x, const Vec<Dim>& impulse);

  double kinetic_energy() const;  ///< [J]
};

/// A body of the volume that the facets bound, at rest where they are, with a mass [kg] spread evenly. Throws Error
/// where they bound none.
template <int Dim>
RigidBody<Dim> make_rigid_body(std::span<const Simplex<Dim>> facets, double mass);

/// Half a leap-frog kick: velocity and angular momentum by load and gravity [m/s^2] over dt [s].
template <int Dim>
void kick_body(RigidBody<Dim>& body, const Vec<Dim>& gravity, double dt);

/// Where it is after dt [s] of free flight: the centre goes straight, and it turns by the spin that its angular
/// momentum gives it at the middle of the step. Second order in dt; the angular momentum is kept exactly.
template <int Dim>
BodyState<Dim> drift_body(const RigidBody<Dim>& body, double dt);

}  // namespace smelt
