// Compiled once for every instruction set, as pair_sums.cpp is.
#define HWY_DISABLED_TARGETS (HWY_AVX3 | HWY_AVX3_DL | HWY_SSE4)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/sph/wall_samples.cpp"
// clang-format off
#include <hwy/foreach_target.h>  // must come before highway.h

#include "core/sph/wall_samples-inl.h"
// clang-format on

#if HWY_ONCE
#include <algorithm>

namespace smelt {

SampleKernel::SampleKernel(const WallKernel<3>& kernel)
    : smoothing_length(kernel.smoothing_length()), n_terms(kernel.terms().size()) {
  for (std::size_t t = 0; t < n_terms; ++t) {
    const RadialTerm& term = kernel.terms()[t];
    terms[t].radius = static_cast<float>(term.radius);
    for (std::size_t k = 0; k < terms[t].shape.size(); ++k) {
      terms[t].shape[k] = static_cast<float>(term.shape[k]);
      terms[t].ray[k] = static_cast<float>(term.ray[k]);
    }
  }
}

void pack_wall_samples(std::span<const WallSample> samples, const Vec3& origin, double side,
                       std::vector<float>& packed) {
  const std::size_t n_groups = (samples.size() + wall_lanes - 1) / wall_lanes;
  for (std::size_t g = 0; g < n_groups; ++g) {
    const std::size_t at = packed.size();
    packed.resize(at + wall_group, 0.0F);
    for (std::size_t lane = 0; lane < wall_lanes; ++lane) {
      const std::size_t k = g * wall_lanes + lane;
      // What fills up stands where another does, so that its distance is not zero either.
      const WallSample& s = samples[std::min(k, samples.size() - 1)];
      for (std::size_t a = 0; a < 3; ++a) {
        const int axis = static_cast<int>(a);
        packed[at + a * wall_lanes + lane] = static_cast<float>(s.centre[axis] - origin[axis]);
        if (k < samples.size()) packed[at + (3 + a) * wall_lanes + lane] = static_cast<float>(side * s.area[axis]);
      }
      if (k >= samples.size()) continue;
      packed[at + 6 * wall_lanes + lane] = static_cast<float>(s.area.norm());
      for (int a = 0, m = 3; a < 3; ++a) {
        packed[at + static_cast<std::size_t>(7 + a) * wall_lanes + lane] = static_cast<float>(s.spread(a, a));
        for (int b = a + 1; b < 3; ++b, ++m)
          packed[at + static_cast<std::size_t>(7 + m) * wall_lanes + lane] = static_cast<float>(s.spread(a, b));
      }
    }
  }
}

HWY_EXPORT(wall_sample_sums);

SampleSums sum_wall_samples(const SampleKernel& kernel, std::span<const float> packed, const Vec3& moved) {
  return HWY_DYNAMIC_DISPATCH(wall_sample_sums)(kernel, packed, moved);
}

}  // namespace smelt
#endif
