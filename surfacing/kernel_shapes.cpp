#include "surfacing/kernel_shapes.h"

#include "core/parallel.h"
#include "surfacing/local_particles.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

constexpr double reach_over_spacing = 3.0;
constexpr double flattening = 0.15;  // power of the variance: measured in docs/decisions/0021
constexpr double least_stretch = 0.5, most_stretch = 1.15;

/// Sums over the neighbours of a particle: of w, and of w times d_a and d_a d_b, d from the particle [R].
struct Moments {
  float weight = 0.0f;
  std::array<float, 3> first{};
  std::array<float, 6> second{};  // xx, yy, zz, xy, xz, yz
};

/// `near` was gathered with h = R/2, its unit of length.
Moments sum_moments(const LocalParticles<0>& near, const Vec3f& at) {
  std::array<Lanes, 10> sum{};
  for (std::size_t j = 0; j < near.size; j += LocalParticles<0>::lanes) {
    const Float8 x = 0.5f * (load8(&near.x[0][j]) - at[0]), y = 0.5f * (load8(&near.x[1][j]) - at[1]),
                 z = 0.5f * (load8(&near.x[2][j]) - at[2]);
    const Float8 r_squared = x * x + y * y + z * z;
    const Float8 w = load8(&near.volume[j]) * positive_part(1.0f - r_squared * sqrt(r_squared));
    const Float8 wx = w * x, wy = w * y, wz = w * z;
    sum[0].value += w;
    sum[1].value += wx;
    sum[2].value += wy;
    sum[3].value += wz;
    sum[4].value += wx * x;
    sum[5].value += wy * y;
    sum[6].value += wz * z;
    sum[7].value += wx * y;
    sum[8].value += wx * z;
    sum[9].value += wy * z;
  }
  Moments m;
  m.weight = sum_of_lanes(sum[0].value);
  for (int a = 0; a < 3; ++a) m.first[a] = sum_of_lanes(sum[1 + a].value);
  for (int a = 0; a < 6; ++a) m.second[a] = sum_of_lanes(sum[4 + a].value);
  return m;
}

KernelShape to_shape(const Moments& moments, double h) {
  constexpr double bulk_variance = 0.15;  // [R^2]
  const double weight = moments.weight;   // its own is 1
  const Vec3 mean = Vec3(moments.first[0], moments.first[1], moments.first[2]) / weight;
  const auto& s = moments.second;
  Mat3 covariance;
  covariance << s[0], s[3], s[4], s[3], s[1], s[5], s[4], s[5], s[2];
  covariance = covariance / weight - mean * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> axes = Eigen::SelfAdjointEigenSolver<Mat3>().computeDirect(covariance);
  const double trust =
      std::clamp((weight - 2.0) / 3.0, 0.0, 1.0);  // how many neighbours there are: 1 or less to 4 or more
  Mat3 inverse = Mat3::Zero();
  Vec3 squares = Vec3::Zero();
  Vec3 stretches;
  for (int k = 0; k < 3; ++k) {
    const double measured = std::clamp(std::pow(std::max(0.0, axes.eigenvalues()[k]) / bulk_variance, flattening),
                                       least_stretch, most_stretch);
    const double stretch = h * (1.0 + trust * (measured - 1.0));
    const Vec3 e = axes.eigenvectors().col(k);
    inverse += e * e.transpose() / (stretch * stretch);
    squares += stretch * stretch * e.cwiseAbs2();
    stretches[k] = stretch;
  }
  KernelShape shape;
  const Vec3 reach = 2.0 * squares.cwiseSqrt();
  shape.m = {static_cast<float>(inverse(0, 0)), static_cast<float>(inverse(1, 1)), static_cast<float>(inverse(2, 2)),
             static_cast<float>(inverse(0, 1)), static_cast<float>(inverse(0, 2)), static_cast<float>(inverse(1, 2))};
  for (int a = 0; a < 3; ++a) shape.reach[a] = static_cast<float>(reach[a]);
  // Eigenvalues ascend: the second is small on threads alone.
  shape.weight = static_cast<float>(std::min(1.0, stretches[1] / (0.75 * h)) / stretches.prod());
  return shape;
}

}  // namespace

KernelShape isotropic_shape(double h) {
  const auto m = static_cast<float>(1.0 / (h * h)), reach = static_cast<float>(2.0 * h);
  return {{m, m, m, 0.0f, 0.0f, 0.0f}, {reach, reach, reach}, static_cast<float>(1.0 / (h * h * h))};
}

KernelShapes compute_kernel_shapes(const ParticleBins& bins, const SurfaceRegion& region, double spacing, double h) {
  // Bins whose kernels reach a surface.
  std::vector<std::uint8_t> wanted(bins.n_bins());
  const double far = 2.0 * most_stretch * h;
  parallel_for_each(bins.n_bins(), [&](std::size_t b) {
    const Box3 box = bins.box(b);
    wanted[b] = region.touches_surface({box.lower.array() - far, box.upper.array() + far});
  });
  KernelShapes shapes;
  shapes.first.assign(bins.n_bins(), KernelShapes::isotropic);
  std::uint32_t n = 0;
  for (std::size_t b = 0; b < bins.n_bins(); ++b) {
    if (wanted[b] == 0) continue;
    shapes.first[b] = n;
    n += bins.begin[b + 1] - bins.begin[b];
  }
  shapes.shape.resize(n);

  const std::vector<float> ones(bins.n_particles(), 1.0f);
  const double half_reach = 0.5 * reach_over_spacing * spacing;
  parallel_blocks(
      bins.n_bins(),
      [&](std::size_t begin, std::size_t end) {
        LocalParticles<0> near;
        for (std::size_t b = begin; b < end; ++b) {
          if (wanted[b] == 0) continue;
          gather_particles(near, bins, ones, bins.box(b), half_reach,
                           [](std::uint32_t) { return std::array<float, 0>{}; });
          for (std::uint32_t j = bins.begin[b]; j < bins.begin[b + 1]; ++j) {
            const Vec3f at = ((bins.position(b, j) - near.origin) / half_reach).cast<float>();
            shapes.shape[shapes.first[b] + j - bins.begin[b]] = to_shape(sum_moments(near, at), h);
          }
        }
      },
      64);
  return shapes;
}

}  // namespace smelt
