#include "core/geometry/pose.h"

#include <Eigen/Geometry>

#include <cmath>

namespace smelt {

Mat<3> to_skew(const Vec<3>& omega) {
  Mat<3> skew;
  skew << 0.0, -omega[2], omega[1], omega[2], 0.0, -omega[0], -omega[1], omega[0], 0.0;
  return skew;
}

Mat<2> to_skew(double omega) {
  Mat<2> skew;
  skew << 0.0, -omega, omega, 0.0;
  return skew;
}

Vec<3> from_skew(const Mat<3>& skew) {
  return {skew(2, 1), skew(0, 2), skew(1, 0)};
}

template <int Dim>
double skew_angle(const Mat<Dim>& skew) {
  if constexpr (Dim == 3) return from_skew(skew).norm();
  if constexpr (Dim == 2) return std::abs(skew(1, 0));
  return 0.0;
}

template <int Dim>
Mat<Dim> rotation_of(const Mat<Dim>& skew) {
  const double angle = skew_angle<Dim>(skew);
  if (angle == 0.0) return Mat<Dim>::Identity();
  if constexpr (Dim == 3) return Eigen::AngleAxisd(angle, from_skew(skew) / angle).toRotationMatrix();
  if constexpr (Dim == 2) {
    const double s = std::sin(skew(1, 0)), c = std::cos(angle);
    Mat<2> rotation;
    rotation << c, -s, s, c;
    return rotation;
  }
  return Mat<Dim>::Identity();
}

template <int Dim>
Mat<Dim> skew_of(const Mat<Dim>& rotation) {
  if constexpr (Dim == 3) {
    const Eigen::AngleAxisd turn{Eigen::Quaterniond(rotation)};
    return to_skew(Vec3(turn.angle() * turn.axis()));
  }
  if constexpr (Dim == 2) return to_skew(std::atan2(rotation(1, 0), rotation(0, 0)));
  return Mat<Dim>::Zero();
}

template <int Dim>
Mat<Dim> to_rotation(const Mat<Dim>& nearly) {
  if constexpr (Dim == 3) return Eigen::Quaterniond(nearly).normalized().toRotationMatrix();
  if constexpr (Dim == 2) {
    const Vec<2> along = nearly.col(0).normalized();
    Mat<2> rotation;
    rotation << along[0], -along[1], along[1], along[0];
    return rotation;
  }
  return Mat<Dim>::Identity();
}

template double skew_angle<1>(const Mat<1>&);
template double skew_angle<2>(const Mat<2>&);
template double skew_angle<3>(const Mat<3>&);
template Mat<1> rotation_of<1>(const Mat<1>&);
template Mat<2> rotation_of<2>(const Mat<2>&);
template Mat<3> rotation_of<3>(const Mat<3>&);
template Mat<1> skew_of<1>(const Mat<1>&);
template Mat<2> skew_of<2>(const Mat<2>&);
template Mat<3> skew_of<3>(const Mat<3>&);
template Mat<1> to_rotation<1>(const Mat<1>&);
template Mat<2> to_rotation<2>(const Mat<2>&);
template Mat<3> to_rotation<3>(const Mat<3>&);

}  // namespace smelt
