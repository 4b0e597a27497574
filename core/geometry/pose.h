#pragma once
// Where a rigid thing is and how it moves, in 1, 2 and 3 dimensions.
//
// Rotations are matrices, and angular velocities skew matrices W with W y = omega x y in 3D (in 2D: omega times y
// turned by 90 degrees), so that one code serves all dimensions.

#include "core/geometry/vec.h"

namespace smelt {

/// x = rotation X + translation takes a point X of the thing at rest to where it is in the world [m].
template <int Dim>
struct Pose {
  Mat<Dim> rotation = Mat<Dim>::Identity();
  Vec<Dim> translation = Vec<Dim>::Zero();

  Vec<Dim> to_world(const Vec<Dim>& rest) const { return rotation * rest + translation; }
  Vec<Dim> to_rest(const Vec<Dim>& world) const { return rotation.transpose() * (world - translation); }
};

/// The velocity field u(x) = velocity + spin (x - centre) [m/s] of a rigid motion.
template <int Dim>
struct Twist {
  Vec<Dim> velocity = Vec<Dim>::Zero();  ///< of the centre [m/s]
  Vec<Dim> centre = Vec<Dim>::Zero();    ///< [m]
  Mat<Dim> spin = Mat<Dim>::Zero();      ///< skew [rad/s]

  Vec<Dim> at(const Vec<Dim>& x) const { return velocity + spin * (x - centre); }
};

/// The skew matrix W with W y = omega x y.
Mat<3> to_skew(const Vec<3>& omega);
/// In 2D, of an angular velocity counter-clockwise.
Mat<2> to_skew(double omega);
/// The vector of a skew matrix.
Vec<3> from_skew(const Mat<3>& skew);

/// Angle [rad] (or angular speed) of a skew matrix: |omega|.
template <int Dim>
double skew_angle(const Mat<Dim>& skew);

/// exp(W): the rotation by |omega| about omega (Rodrigues).
template <int Dim>
Mat<Dim> rotation_of(const Mat<Dim>& skew);

/// The W of least angle with exp(W) = rotation; at half a turn either of the two.
template <int Dim>
Mat<Dim> skew_of(const Mat<Dim>& rotation);

/// The rotation nearest to a matrix that rounding has taken a little off.
template <int Dim>
Mat<Dim> to_rotation(const Mat<Dim>& nearly);

}  // namespace smelt
