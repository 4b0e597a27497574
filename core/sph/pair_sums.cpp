// Compiled once for every instruction set that the machine at run time may have (Highway's dynamic dispatch), with the
// same bytes (sum_row). Double precision, which serves studies, has AVX2 only.
#include "core/sph/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/sph/pair_sums.cpp"
// clang-format off
#include <hwy/foreach_target.h>  // must come before highway.h

#include "core/sph/pair_sums-inl.h"
// clang-format on

#if HWY_ONCE
namespace smelt {

// Highway's tables hold plain functions: one for each dimension and precision.
HWY_EXPORT(rate_sums_3f);
HWY_EXPORT(force_sums_3f);
HWY_EXPORT(gas_force_sums_3f);
HWY_EXPORT(density_sums_3f);
#define SMELT_DISPATCH(Dim, Real, suffix, CALL)                                                                        \
  template <>                                                                                                          \
  void compute_rate_sums<Dim, Real>(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,                  \
                                    const PairTerms& terms, double smoothing_length, std::size_t begin,                \
                                    std::size_t end, RateSums<Dim, Real>* sums, SightedSums<Dim, Real>* sighted) {     \
    CALL(rate_sums_##suffix)(fields, lists, terms, smoothing_length, begin, end, sums, sighted);                       \
  }                                                                                                                    \
  template <>                                                                                                          \
  void compute_force_sums<Dim, Real>(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,                 \
                                     const PairTerms& terms, const ForceParameters& parameters, std::size_t begin,     \
                                     std::size_t end, std::array<Real, Dim>* acceleration) {                           \
    CALL(force_sums_##suffix)(fields, lists, terms, parameters, begin, end, acceleration);                             \
  }                                                                                                                    \
  template <>                                                                                                          \
  void compute_gas_force_sums<Dim, Real>(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,             \
                                         KernelType kernel, const GasForceParameters& parameters, std::size_t begin,   \
                                         std::size_t end, std::array<Real, Dim>* acceleration, Real* energy_rate) {    \
    CALL(gas_force_sums_##suffix)(fields, lists, kernel, parameters, begin, end, acceleration, energy_rate);           \
  }                                                                                                                    \
  template <>                                                                                                          \
  void compute_density_sums<Dim, Real>(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,               \
                                       KernelType kernel, double smoothing_length, std::size_t begin, std::size_t end, \
                                       DensitySums<Real>* sums) {                                                      \
    CALL(density_sums_##suffix)(fields, lists, kernel, smoothing_length, begin, end, sums);                            \
  }
SMELT_DISPATCH(3, float, 3f, HWY_DYNAMIC_DISPATCH)
SMELT_DISPATCH(3, double, 3d, HWY_STATIC_DISPATCH)
SMELT_DISPATCH(2, double, 2d, HWY_STATIC_DISPATCH)
SMELT_DISPATCH(1, double, 1d, HWY_STATIC_DISPATCH)

}  // namespace smelt
#endif
