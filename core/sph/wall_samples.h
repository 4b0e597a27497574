#pragma once
// Sums over samples of a wall, eight at a time.

#include "core/sph/kernel.h"
#include "core/sph/wall_integrals.h"
#include "core/sph/wall_tree.h"

#include <array>
#include <span>
#include <vector>

namespace smelt {

constexpr std::size_t wall_lanes = 8;
/// Floats of one group of lanes: place (3), area vector (3), area, spread (6: xx, yy, zz, xy, xz, yz).
constexpr std::size_t wall_group = 13 * wall_lanes;

/// Appends samples relative to `origin`, with their area vectors times `side`, filled up to whole groups with ones of
/// no area.
void pack_wall_samples(std::span<const WallSample> samples, const Vec3& origin, double side,
                       std::vector<float>& packed);

/// What integrate_facet() gives, summed, each sample by its centre and its spread M: a function f(r) of the distance
/// has over it the mean
///   f + 1/2 [ tr M f'/r + y.My/r^2 (f'' - f'/r) ],
/// exact to the third order in its size. n.y hardly changes over it.
struct SampleSums {
  double area = 0.0;           ///< A [1/m]
  Vec3 normal = Vec3::Zero();  ///< int W n dS [1/m]
  Vec3 first = Vec3::Zero();   ///< int y W dS [-]
  double solid = 0.0;          ///< Gamma [-]
  Mat3 moment = Mat3::Zero();  ///< Gamma I - int y (x) n W dS, symmetric part [-]
};

/// A kernel's radial polynomials in single precision.
struct SampleKernel {
  explicit SampleKernel(const WallKernel<3>& kernel);
  struct Term {
    float radius;
    std::array<float, 9> shape, ray;
  };
  double smoothing_length;
  std::array<Term, 3> terms{};
  std::size_t n_terms;
};

/// `moved`: of the particle, from the samples' origin [m].
SampleSums sum_wall_samples(const SampleKernel& kernel, std::span<const float> packed, const Vec3& moved);

}  // namespace smelt
