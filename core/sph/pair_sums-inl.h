// The pair loops for one instruction set; included once per target by pair_sums.cpp.
#if defined(SMELT_PAIR_SUMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SMELT_PAIR_SUMS_INL_H
#undef SMELT_PAIR_SUMS_INL_H
#else
#define SMELT_PAIR_SUMS_INL_H
#endif

#include "core/sph/force_sums-inl.h"
#include "core/sph/pair_records-inl.h"
#include "core/sph/pair_sums.h"
#include "core/sph/rate_sums-inl.h"

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace smelt {
namespace HWY_NAMESPACE {

template <typename PairKernel, int Dim, typename Real>
void density_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, double h, std::size_t begin,
                  std::size_t end, DensitySums<Real>* sums) {
  const Tag<Real> d;
  const PairKernel kernel(h);
  using Fields = PairFields<Dim, Real>;
  std::vector<std::int32_t> buffer(lists.room());
  for (std::size_t i = begin; i < end; ++i) {
    const Real* record_i = fields.record(i);
    const NeighbourLists::Row row = fields.read_row(lists, i, buffer.data());
    const std::int32_t* row_end = row.neighbours.data() + row.neighbours.size();
    const auto add_pairs = [&](const std::int32_t* begins, Simd<Real>* sum) HWY_ATTR __attribute__((always_inline)) {
      const Neighbours<Dim, Real> pair(record_i, fields.records.data(), begins);
      // The padding is the particle itself, whose W is not nothing: it counts once, below.
      const auto n_left = static_cast<std::size_t>(std::max<std::ptrdiff_t>(row_end - begins, 0));
      const auto w = hn::IfThenElseZero(hn::FirstN(d, n_left), kernel.value(dot<Dim, Real>(pair.x_ij, pair.x_ij)));
      const auto volume_w = hn::Mul(pair.volume, w);
      sum[0] = hn::MulAdd(pair.density, volume_w, sum[0]);
      sum[1] = hn::Add(volume_w, sum[1]);
    };
    Real total[2];
    sum_row<2>(row, total, add_pairs);
    const Real self = record_i[Fields::volume_at] * hn::GetLane(kernel.value(hn::Zero(d)));
    sums[i - begin].mass = total[0] + record_i[Fields::density_at] * self;
    sums[i - begin].volume = total[1] + self;
  }
}

#define SMELT_INSTANTIATE(Dim, Real, suffix)                                                                           \
  inline void rate_sums_##suffix(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,                     \
                                 const PairTerms& terms, double h, std::size_t begin, std::size_t end,                 \
                                 RateSums<Dim, Real>* sums, SightedSums<Dim, Real>* sighted) {                         \
    with_kernel<Dim, Real>(terms.kernel, [&](auto kernel) HWY_ATTR {                                                   \
      select_rate_sums<typename decltype(kernel)::type, Dim, Real>(fields, lists, terms, h, begin, end, sums,          \
                                                                   sighted);                                           \
    });                                                                                                                \
  }                                                                                                                    \
  inline void force_sums_##suffix(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,                    \
                                  const PairTerms& terms, const ForceParameters& parameters, std::size_t begin,        \
                                  std::size_t end, std::array<Real, Dim>* acceleration) {                              \
    with_kernel<Dim, Real>(terms.kernel, [&](auto kernel) HWY_ATTR {                                                   \
      select_force_sums<typename decltype(kernel)::type, Dim, Real>(fields, lists, terms, parameters, begin, end,      \
                                                                    acceleration);                                     \
    });                                                                                                                \
  }                                                                                                                    \
  inline void gas_force_sums_##suffix(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,                \
                                      KernelType type, const GasForceParameters& parameters, std::size_t begin,        \
                                      std::size_t end, std::array<Real, Dim>* acceleration, Real* energy_rate) {       \
    with_kernel<Dim, Real>(type, [&](auto kernel) HWY_ATTR {                                                           \
      gas_force_sums<typename decltype(kernel)::type, Dim, Real>(fields, lists, parameters, begin, end, acceleration,  \
                                                                 energy_rate);                                         \
    });                                                                                                                \
  }                                                                                                                    \
  inline void density_sums_##suffix(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, KernelType type, \
                                    double h, std::size_t begin, std::size_t end, DensitySums<Real>* sums) {           \
    with_kernel<Dim, Real>(type, [&](auto kernel) HWY_ATTR {                                                           \
      density_sums<typename decltype(kernel)::type, Dim, Real>(fields, lists, h, begin, end, sums);                    \
    });                                                                                                                \
  }
SMELT_INSTANTIATE(3, float, 3f)
#if HWY_TARGET == HWY_STATIC_TARGET
// Studies do not need the fastest instructions.
SMELT_INSTANTIATE(3, double, 3d)
SMELT_INSTANTIATE(2, double, 2d)
SMELT_INSTANTIATE(1, double, 1d)
#endif
#undef SMELT_INSTANTIATE

}  // namespace HWY_NAMESPACE
}  // namespace smelt
HWY_AFTER_NAMESPACE();

#endif  // SMELT_PAIR_SUMS_INL_H
