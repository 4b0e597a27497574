// Compiled once for every instruction set, as pair_sums.cpp is.
#include "core/sph/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/sph/pressure_sums.cpp"
// clang-format off
#include <hwy/foreach_target.h>  // must come before highway.h

#include "core/sph/pressure_sums-inl.h"
// clang-format on

#if HWY_ONCE
namespace smelt {

HWY_EXPORT(pressure_gradient_sums_3f);
HWY_EXPORT(pressure_diffusion_sums_3f);
#define SMELT_DISPATCH(Dim, Real, suffix, CALL)                                                                     \
  template <>                                                                                                       \
  void compute_pressure_gradient_sums<Dim, Real>(                                                                   \
      const PairFields<Dim, Real>& fields, const NeighbourLists& lists, KernelType kernel, double smoothing_length, \
      std::span<const std::int32_t> particles, PressureGradientSums<Dim, Real>* sums) {                             \
    CALL(pressure_gradient_sums_##suffix)(fields, lists, kernel, smoothing_length, particles, sums);                \
  }                                                                                                                 \
  template <>                                                                                                       \
  void compute_pressure_diffusion_sums<Dim, Real>(                                                                  \
      const PairFields<Dim, Real>& fields, const std::vector<Real>& gradients, const NeighbourLists& lists,         \
      KernelType kernel, double smoothing_length, std::size_t begin, std::size_t end, Real* sums) {                 \
    CALL(pressure_diffusion_sums_##suffix)                                                                          \
    (fields, gradients, lists, kernel, smoothing_length, begin, end, sums);                                         \
  }
SMELT_DISPATCH(3, float, 3f, HWY_DYNAMIC_DISPATCH)
SMELT_DISPATCH(3, double, 3d, HWY_STATIC_DISPATCH)
SMELT_DISPATCH(2, double, 2d, HWY_STATIC_DISPATCH)
SMELT_DISPATCH(1, double, 1d, HWY_STATIC_DISPATCH)

}  // namespace smelt
#endif
