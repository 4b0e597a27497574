// Compiled once for every instruction set that the machine at run time may have (Highway's dynamic dispatch).
// AVX2, which smelt asks of any machine (Highway would start lower, as x86-64-v3 does not promise AES), and AVX-512,
// with the same bytes (sum_row).
#define HWY_BASELINE_TARGETS HWY_AVX2
#define HWY_DISABLED_TARGETS HWY_AVX3_DL
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/sph/pair_sums.cpp"
// clang-format off
#include <hwy/foreach_target.h>  // must come before highway.h

#include "core/sph/pair_sums-inl.h"
// clang-format on

#if HWY_ONCE
namespace smelt {

// Highway's tables hold plain functions: one for each dimension and precision.
#define SMELT_EXPORT(suffix)           \
  HWY_EXPORT(rate_sums_##suffix);      \
  HWY_EXPORT(force_sums_##suffix);     \
  HWY_EXPORT(gas_force_sums_##suffix); \
  HWY_EXPORT(density_sums_##suffix);
SMELT_EXPORT(3f)
SMELT_EXPORT(3d)
SMELT_EXPORT(2d)
SMELT_EXPORT(1d)
#define SMELT_DISPATCH(Dim, Real, suffix)                                                                              \
  template <>                                                                                                          \
  void compute_rate_sums<Dim, Real>(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,                  \
                                    const PairTerms& terms, double smoothing_length, std::size_t begin,                \
                                    std::size_t end, RateSums<Dim, Real>* sums, SightedSums<Dim, Real>* sighted) {     \
    HWY_DYNAMIC_DISPATCH(rate_sums_##suffix)(fields, lists, terms, smoothing_length, begin, end, sums, sighted);       \
  }                                                                                                                    \
  template <>                                                                                                          \
  void compute_force_sums<Dim, Real>(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,                 \
                                     const PairTerms& terms, const ForceParameters& parameters, std::size_t begin,     \
                                     std::size_t end, std::array<Real, Dim>* acceleration) {                           \
    HWY_DYNAMIC_DISPATCH(force_sums_##suffix)(fields, lists, terms, parameters, begin, end, acceleration);             \
  }                                                                                                                    \
  template <>                                                                                                          \
  void compute_gas_force_sums<Dim, Real>(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,             \
                                         KernelType kernel, const GasForceParameters& parameters, std::size_t begin,   \
                                         std::size_t end, std::array<Real, Dim>* acceleration, Real* energy_rate) {    \
    HWY_DYNAMIC_DISPATCH(gas_force_sums_##suffix)                                                                      \
    (fields, lists, kernel, parameters, begin, end, acceleration, energy_rate);                                        \
  }                                                                                                                    \
  template <>                                                                                                          \
  void compute_density_sums<Dim, Real>(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,               \
                                       KernelType kernel, double smoothing_length, std::size_t begin, std::size_t end, \
                                       DensitySums<Real>* sums) {                                                      \
    HWY_DYNAMIC_DISPATCH(density_sums_##suffix)(fields, lists, kernel, smoothing_length, begin, end, sums);            \
  }
SMELT_DISPATCH(3, float, 3f)
SMELT_DISPATCH(3, double, 3d)
SMELT_DISPATCH(2, double, 2d)
SMELT_DISPATCH(1, double, 1d)

}  // namespace smelt
#endif
