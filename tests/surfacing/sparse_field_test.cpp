#include "surfacing/sparse_field.h"

#include "core/error.h"
#include "core/sph/kernel.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace smelt {
namespace {

std::vector<Vec3> cubic_lattice(int n, double spacing) {
  std::vector<Vec3> x;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) x.push_back(spacing * Vec3(i, j, k));
  return x;
}

TEST(SparseField, ChiEqualsTheBruteForceSum) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-1.0, 1.0), size(0.5, 1.5);
  const double h = 0.21, cell = 0.09;
  std::vector<Vec3> x(300);
  for (Vec3& p : x) p = Vec3(place(random), place(random), place(random)) + Vec3(100.0, -3.0, 0.0);
  const ParticleBins bins = sort_into_bins(x, 2.0 * h);
  std::vector<float> volume(x.size());
  for (float& v : volume) v = static_cast<float>(0.008 * size(random));
  const SparseField field = compute_chi({bins, volume, h}, cell, 0.5f, 1e9);

  const Kernel<3> kernel(h);
  double largest = 0.0;
  std::size_t n_positive = 0;
  for (int k = -16; k <= 16; k += 2)
    for (int j = -49; j <= -17; ++j)
      for (int i = 1095; i <= 1127; i += 3) {
        double exact = 0.0;
        for (std::size_t p = 0; p < x.size(); ++p)
          exact += volume[p] * kernel.value((cell * Vec3(i, j, k) - x[bins.index[p]]).norm());
        largest = std::max(largest, std::abs(exact - field.sample(i, j, k)));
        n_positive += exact > 0.0;
      }
  EXPECT_GT(n_positive, 1000u);
  EXPECT_LT(largest, 5e-6);
}

/// The same with an ellipsoid for every second bin, turned at random and stretched by 0.5 to 1.3 along its axes.
TEST(SparseField, ChiOfEllipsoidsEqualsTheBruteForceSum) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1.0, 1.0), size(0.5, 1.5), stretch(0.5, 1.3), angle(0.0, 6.0);
  const double h = 0.21, cell = 0.09;
  std::vector<Vec3> x(300);
  for (Vec3& p : x) p = Vec3(place(random), place(random), place(random));
  const ParticleBins bins = sort_into_bins(x, 2.0 * h);
  std::vector<float> volume(x.size());
  for (float& v : volume) v = static_cast<float>(0.008 * size(random));
  KernelShapes shapes;
  std::vector<Mat3> metric(x.size(), Mat3::Identity() / (h * h));
  std::vector<double> weight(x.size(), 1.0 / (h * h * h));
  for (std::size_t b = 0; b < bins.n_bins(); ++b) {
    shapes.first.push_back(b % 2 == 0 ? KernelShapes::isotropic : static_cast<std::uint32_t>(shapes.shape.size()));
    if (b % 2 == 0) continue;
    for (std::uint32_t j = bins.begin[b]; j < bins.begin[b + 1]; ++j) {
      const Mat3 turn = Eigen::AngleAxisd(angle(random), Vec3(place(random), place(random), 1.5).normalized()).matrix();
      const Vec3 axes = h * Vec3(stretch(random), stretch(random), stretch(random));
      metric[j] = turn * axes.cwiseAbs2().cwiseInverse().asDiagonal() * turn.transpose();
      weight[j] = 1.0 / axes.prod();
      const Mat3& m = metric[j];
      const Vec3 reach = 2.0 * m.inverse().diagonal().cwiseSqrt();
      KernelShape s;
      for (int n = 0; n < 6; ++n)
        s.m[n] = static_cast<float>(n < 3 ? m(n, n) : n == 3 ? m(0, 1) : n == 4 ? m(0, 2) : m(1, 2));
      for (int a = 0; a < 3; ++a) s.reach[a] = static_cast<float>(reach[a]);
      s.weight = static_cast<float>(weight[j]);
      shapes.shape.push_back(s);
    }
  }
  const SparseField field = compute_chi({bins, volume, h, &shapes}, cell, 0.5f, 1e9);

  const Kernel<3> kernel(1.0);
  double largest = 0.0;
  std::size_t n_positive = 0;
  for (int k = -18; k <= 18; k += 2)
    for (int j = -18; j <= 18; ++j)
      for (int i = -18; i <= 18; i += 3) {
        double exact = 0.0;
        for (std::size_t p = 0; p < x.size(); ++p) {
          const Vec3 d = cell * Vec3(i, j, k) - x[bins.index[p]];
          exact += volume[p] * weight[p] * kernel.value(std::sqrt(d.dot(metric[p] * d)));
        }
        largest = std::max(largest, std::abs(exact - field.sample(i, j, k)));
        n_positive += exact > 0.0;
      }
  EXPECT_GT(n_positive, 1000u);
  EXPECT_LT(largest, 5e-6);
}

TEST(SparseField, ChiIsOneInsideALattice) {
  const double spacing = 0.03;
  const std::vector<Vec3> x = cubic_lattice(14, spacing);
  for (const double h : {1.0 * spacing, 1.2 * spacing}) {
    const ParticleBins bins = sort_into_bins(x, 2.0 * h);
    const std::vector<float> volume(x.size(), static_cast<float>(spacing * spacing * spacing));
    const SparseField field = compute_chi({bins, volume, h}, 0.5 * spacing, 0.5f, 1e9);
    for (int k = 8; k <= 18; ++k)
      for (int j = 8; j <= 18; ++j)
        for (int i = 8; i <= 18; ++i) ASSERT_NEAR(field.sample(i, j, k), 1.0f, 0.02f);
    EXPECT_EQ(field.sample(-40, 0, 0), 0.0f);
  }
}

TEST(SparseField, HoldsEverySampleThatAParticleReachesAndThoseBelow) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-3.0, 3.0);
  std::vector<Vec3> x(40);
  for (Vec3& p : x) p = Vec3(place(random), place(random), place(random));
  const double radius = 0.37, cell = 0.11;
  const SparseField field = allocate_field(sort_into_bins(x, radius), radius, cell, 1e9);
  for (const Vec3& p : x)
    for (int k = -4; k <= 4; ++k)
      for (int j = -4; j <= 4; ++j)
        for (int i = -4; i <= 4; ++i) {
          Lattice s;
          for (int a = 0; a < 3; ++a) s[a] = floor_to_int(p[a] / cell) + std::array{i, j, k}[a];
          if ((cell * Vec3(s[0], s[1], s[2]) - p).norm() > radius) continue;
          for (int n = 0; n < 8; ++n)
            ASSERT_NE(
                field.find(lattice_key((s[0] - (n & 1)) >> 3, (s[1] - (n >> 1 & 1)) >> 3, (s[2] - (n >> 2)) >> 3)),
                SparseField::no_block);
        }
}

TEST(SparseField, FarParticlesCostNoSpaceBetweenThem) {
  const std::vector<Vec3> x = {Vec3(0, 0, 0), Vec3(900, -900, 900), Vec3(-900, 900, 0)};
  const SparseField field = allocate_field(sort_into_bins(x, 0.06), 0.06, 0.015, 1e9);
  EXPECT_LE(field.n_blocks(), 3u * 27u);
}

/// The message of the error that an action throws.
template <typename Action>
std::string message_of(Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(SparseField, RefusesWhatCannotBeGridded) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto sorted = [](const Vec3& odd) {
    const std::vector<Vec3> x = {Vec3(0, 0, 0), odd};
    return sort_into_bins(x, 0.1);
  };
  for (const double bad : {nan, infinity, -infinity, 1e9})
    EXPECT_NE(message_of([&] { sorted(Vec3(0, bad, 0)); }).find("particle 1"), std::string::npos);

  // Finer and finer cells about 1000 particles: the error names the memory, and comes at once.
  const ParticleBins bins = sort_into_bins(cubic_lattice(10, 0.1), 0.2);
  for (const double cell : {1e-3, 1e-4, 1e-6}) {
    const std::string message = message_of([&] { allocate_field(bins, 0.2, cell, 1e8); });
    EXPECT_NE(message.find("GB"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace smelt
