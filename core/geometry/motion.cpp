#include "core/geometry/motion.h"

#include "core/error.h"

#include <algorithm>

namespace smelt {

namespace {

/// The stretch from one keyframe to the next, and how far on it is.
template <int Dim>
struct Stretch {
  const Keyframe<Dim>* from;
  Vec<Dim> way;        ///< [m]
  Mat<Dim> turn;       ///< skew [rad]
  double share = 0.0;  ///< of way and turn
  double rate = 0.0;   ///< of the share [1/s]
  double rise = 0.0;   ///< of the rate [1/s^2]
};

template <int Dim>
Stretch<Dim> stretch_between(const Motion<Dim>& motion, std::size_t k) {
  const Keyframe<Dim>&a = motion.keyframes[k], &b = motion.keyframes[k + 1];
  // The shorter way round, as slerp takes it.
  return {&a, b.translation - a.translation, skew_of<Dim>(b.rotation * a.rotation.transpose())};
}

/// Which stretch `time` lies in: of two that meet, the later.
template <int Dim>
std::size_t stretch_index(const Motion<Dim>& motion, double time) {
  const auto& keys = motion.keyframes;
  const auto after =
      std::upper_bound(keys.begin(), keys.end(), time, [](double t, const auto& key) { return t < key.time; });
  return static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(after - keys.begin() - 1, 0, static_cast<std::ptrdiff_t>(keys.size()) - 2));
}

template <int Dim>
Stretch<Dim> stretch_at(const Motion<Dim>& motion, double time) {
  CHECK_GT(motion.keyframes.size(), std::size_t{1});
  const std::size_t k = stretch_index(motion, time);
  Stretch<Dim> stretch = stretch_between(motion, k);
  const double duration = motion.keyframes[k + 1].time - stretch.from->time;
  const double s = (time - stretch.from->time) / duration;
  if (s >= 1.0) stretch.share = 1.0;
  if (s < 0.0 || s >= 1.0) return stretch;
  stretch.share = motion.smooth ? s * s * (3.0 - 2.0 * s) : s;
  stretch.rate = (motion.smooth ? 6.0 * s * (1.0 - s) : 1.0) / duration;
  stretch.rise = motion.smooth ? (6.0 - 12.0 * s) / (duration * duration) : 0.0;
  return stretch;
}

}  // namespace

template <int Dim>
bool Motion<Dim>::turns() const {
  return !spin.isZero(0.0) || std::any_of(keyframes.begin(), keyframes.end(), [&](const Keyframe<Dim>& key) {
    return key.rotation != keyframes.front().rotation;
  });
}

template <int Dim>
Pose<Dim> pose_at(const Motion<Dim>& motion, double time) {
  Pose<Dim> pose;
  if (motion.keyframes.empty()) {
    if (!motion.spin.isZero(0.0)) pose.rotation = rotation_of<Dim>(time * motion.spin);
    pose.translation = time * motion.velocity;
  } else {
    const Stretch<Dim> stretch = stretch_at(motion, time);
    pose.rotation = rotation_of<Dim>(stretch.share * stretch.turn) * stretch.from->rotation;
    pose.translation = stretch.from->translation + stretch.share * stretch.way;
  }
  pose.translation += motion.pivot - pose.rotation * motion.pivot;
  return pose;
}

template <int Dim>
Twist<Dim> twist_at(const Motion<Dim>& motion, double time) {
  if (motion.keyframes.empty()) return {motion.velocity, motion.pivot + time * motion.velocity, motion.spin};
  const Stretch<Dim> stretch = stretch_at(motion, time);
  return {stretch.rate * stretch.way, motion.pivot + stretch.from->translation + stretch.share * stretch.way,
          stretch.rate * stretch.turn};
}

template <int Dim>
RigidAcceleration<Dim> acceleration_at(const Motion<Dim>& motion, double time) {
  const Twist<Dim> twist = twist_at(motion, time);
  RigidAcceleration<Dim> acceleration{Vec<Dim>::Zero(), twist.centre, twist.spin * twist.spin};
  if (motion.keyframes.empty()) return acceleration;
  const Stretch<Dim> stretch = stretch_at(motion, time);
  acceleration.linear = stretch.rise * stretch.way;
  acceleration.gradient += stretch.rise * stretch.turn;
  return acceleration;
}

template <int Dim>
double speed_bound(const Motion<Dim>& motion, double begin, double end, double reach) {
  if (motion.keyframes.empty()) return motion.velocity.norm() + reach * skew_angle<Dim>(motion.spin);
  if (end < motion.keyframes.front().time || begin >= motion.keyframes.back().time) return 0.0;
  double fastest = 0.0;
  for (std::size_t k = stretch_index(motion, begin); k + 1 < motion.keyframes.size() && motion.keyframes[k].time <= end;
       ++k) {
    const Stretch<Dim> stretch = stretch_between(motion, k);
    // A smooth stretch is fastest in its middle.
    const double rate = (motion.smooth ? 1.5 : 1.0) / (motion.keyframes[k + 1].time - stretch.from->time);
    fastest = std::max(fastest, rate * (stretch.way.norm() + reach * skew_angle<Dim>(stretch.turn)));
  }
  return fastest;
}

template struct Motion<1>;
template struct Motion<2>;
template struct Motion<3>;
template Pose<1> pose_at(const Motion<1>&, double);
template Pose<2> pose_at(const Motion<2>&, double);
template Pose<3> pose_at(const Motion<3>&, double);
template Twist<1> twist_at(const Motion<1>&, double);
template Twist<2> twist_at(const Motion<2>&, double);
template Twist<3> twist_at(const Motion<3>&, double);
template RigidAcceleration<1> acceleration_at(const Motion<1>&, double);
template RigidAcceleration<2> acceleration_at(const Motion<2>&, double);
template RigidAcceleration<3> acceleration_at(const Motion<3>&, double);
template double speed_bound(const Motion<1>&, double, double, double);
template double speed_bound(const Motion<2>&, double, double, double);
template double speed_bound(const Motion<3>&, double, double, double);

}  // namespace smelt
