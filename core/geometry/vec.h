#pragma once
// Small vectors and matrices: Eigen's, under the names the rest of smelt uses.

#include <Eigen/Core>

#include <limits>

namespace smelt {

template <int Dim>
using Vec = Eigen::Matrix<double, Dim, 1>;
template <int Dim>
using Vecf = Eigen::Matrix<float, Dim, 1>;
template <int Dim>
using Mat = Eigen::Matrix<double, Dim, Dim>;

using Vec3 = Vec<3>;
using Vec3f = Vecf<3>;
using Mat3 = Mat<3>;

/// An axis-aligned box; empty while lower > upper.
template <int Dim>
struct Box {
  Vec<Dim> lower = Vec<Dim>::Constant(std::numeric_limits<double>::infinity());
  Vec<Dim> upper = Vec<Dim>::Constant(-std::numeric_limits<double>::infinity());

  void extend(const Vec<Dim>& point) {
    lower = lower.cwiseMin(point);
    upper = upper.cwiseMax(point);
  }
  bool empty() const { return (lower.array() > upper.array()).any(); }
  Vec<Dim> extent() const { return upper - lower; }
  Vec<Dim> centre() const { return 0.5 * (lower + upper); }
};

using Box3 = Box<3>;

}  // namespace smelt
