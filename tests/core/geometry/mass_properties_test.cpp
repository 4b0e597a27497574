#include "core/geometry/mass_properties.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace smelt {
namespace {

/// Facets of the box [0, size], wound outward, then moved.
std::vector<Simplex<3>> make_box(const Vec3& size, const Mat3& turn, const Vec3& shift) {
  std::vector<Simplex<3>> facets;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1}) {
      const auto corner = [&](int u, int v) {
        Vec3 x;
        x[axis] = side * size[axis];
        x[(axis + 1) % 3] = u * size[(axis + 1) % 3];
        x[(axis + 2) % 3] = v * size[(axis + 2) % 3];
        return Vec3(turn * x + shift);
      };
      Simplex<3> first{corner(0, 0), corner(1, 0), corner(1, 1)}, second{corner(0, 0), corner(1, 1), corner(0, 1)};
      if (side == 0) {
        std::swap(first[1], first[2]);
        std::swap(second[1], second[2]);
      }
      facets.push_back(first);
      facets.push_back(second);
    }
  return facets;
}

TEST(MassProperties, OfATurnedBoxFarOff) {
  const Vec3 size(0.3, 1.1, 2.0), shift(50.0, -20.0, 7.0);
  const Mat3 turn = Eigen::AngleAxisd(0.8, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const auto facets = make_box(size, turn, shift);
  const MassProperties<3> p = compute_mass_properties<3>(facets);
  const double volume = size.prod();
  EXPECT_NEAR(p.volume, volume, 1e-12 * volume);
  EXPECT_NEAR((p.centre - (turn * (0.5 * size) + shift)).norm(), 0.0, 1e-12);
  // int x^2 dV over an edge a, about the middle: V a^2/12.
  const Mat3 second = turn * Vec3(volume / 12.0 * size.cwiseProduct(size)).asDiagonal() * turn.transpose();
  EXPECT_NEAR((p.second - second).norm(), 0.0, 1e-12 * second.norm());
}

// An L of three cubes is not convex: the sum of its parts.
TEST(MassProperties, OfAPlaneShapeAgainstASum) {
  const std::vector<Vec<2>> outline{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  std::vector<Simplex<2>> segments;
  for (std::size_t k = 0; k < outline.size(); ++k) segments.push_back({outline[k], outline[(k + 1) % outline.size()]});
  const MassProperties<2> p = compute_mass_properties<2>(segments);
  EXPECT_NEAR(p.volume, 3.0, 1e-14);
  EXPECT_NEAR((p.centre - Vec<2>(2.5 / 3.0, 2.5 / 3.0)).norm(), 0.0, 1e-14);
  Mat<2> second = Mat<2>::Zero();
  for (const Vec<2>& square : {Vec<2>(0.5, 0.5), Vec<2>(1.5, 0.5), Vec<2>(0.5, 1.5)}) {
    const Vec<2> arm = square - p.centre;
    second += arm * arm.transpose() + Mat<2>::Identity() / 12.0;
  }
  EXPECT_NEAR((p.second - second).norm(), 0.0, 1e-13);
}

TEST(MassProperties, InwardFacetsHaveANegativeVolume) {
  auto facets = make_box(Vec3(1, 1, 1), Mat3::Identity(), Vec3::Zero());
  for (auto& f : facets) std::swap(f[0], f[1]);
  EXPECT_NEAR(compute_mass_properties<3>(facets).volume, -1.0, 1e-14);
}

}  // namespace
}  // namespace smelt
