#pragma once
// Motions given in advance: a constant velocity and spin, or keyframes.

#include "core/geometry/pose.h"

#include <vector>

namespace smelt {

/// Where a thing is at one time.
template <int Dim>
struct Keyframe {
  double time = 0.0;                         ///< [s]
  Vec<Dim> translation = Vec<Dim>::Zero();   ///< of the pivot, from where it is at rest [m]
  Mat<Dim> rotation = Mat<Dim>::Identity();  ///< about the pivot
};

/// x = R(t) (X - pivot) + pivot + d(t). With keyframes R and d run from one to the next, R by the shorter way at an
/// even rate (slerp); before the first and after the last it stands still. Without them, d = velocity t and R =
/// exp(spin t).
template <int Dim>
struct Motion {
  Vec<Dim> velocity = Vec<Dim>::Zero();  ///< of the pivot [m/s]; not with keyframes
  Mat<Dim> spin = Mat<Dim>::Zero();      ///< skew [rad/s]; not with keyframes
  Vec<Dim> pivot = Vec<Dim>::Zero();     ///< [m], at rest
  std::vector<Keyframe<Dim>> keyframes;  ///< at rising times, two or more, or none
  /// Between keyframes with the share 3s^2 - 2s^3 of the way at the share s of the time, so that it starts and stops
  /// gently at each; otherwise at a constant speed.
  bool smooth = false;

  bool still() const { return keyframes.empty() && velocity.isZero(0.0) && spin.isZero(0.0); }
  /// Whether it ever turns.
  bool turns() const;
};

/// Where it is at `time` [s].
template <int Dim>
Pose<Dim> pose_at(const Motion<Dim>& motion, double time);

/// How it moves at `time` [s]; at a keyframe, as it goes on.
template <int Dim>
Twist<Dim> twist_at(const Motion<Dim>& motion, double time);

/// The field a(x) = linear + gradient (x - centre) of a rigid motion's acceleration [m/s^2]: what stays with it feels
/// minus that.
template <int Dim>
struct RigidAcceleration {
  Vec<Dim> linear = Vec<Dim>::Zero();
  Vec<Dim> centre = Vec<Dim>::Zero();    ///< [m]
  Mat<Dim> gradient = Mat<Dim>::Zero();  ///< spin^2 and the spin's rate [1/s^2]

  Vec<Dim> at(const Vec<Dim>& x) const { return linear + gradient * (x - centre); }
};

/// At `time` [s]; the jolt where a motion changes its speed at once is left out.
template <int Dim>
RigidAcceleration<Dim> acceleration_at(const Motion<Dim>& motion, double time);

/// At least the speed [m/s] of anything within `reach` [m] of the pivot between `begin` and `end` [s].
template <int Dim>
double speed_bound(const Motion<Dim>& motion, double begin, double end, double reach);

}  // namespace smelt
