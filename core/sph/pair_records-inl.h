// How the pair loops read particles, for one instruction set.
#if defined(SMELT_PAIR_RECORDS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SMELT_PAIR_RECORDS_INL_H
#undef SMELT_PAIR_RECORDS_INL_H
#else
#define SMELT_PAIR_RECORDS_INL_H
#endif

#include "core/sph/pair_kernels-inl.h"
#include "core/sph/pair_sums.h"
#include "core/sph/particles.h"

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace smelt {
namespace HWY_NAMESPACE {

/// Turns four vectors of rows (in blocks of four lanes) into four vectors of columns.
HWY_INLINE void transpose_blocks(Simd<float>& row0, Simd<float>& row1, Simd<float>& row2, Simd<float>& row3) {
  const Tag<float> d;
  const hn::Repartition<double, Tag<float>> wide;
  const auto pairs01_low = hn::BitCast(wide, hn::InterleaveLower(d, row0, row1));
  const auto pairs23_low = hn::BitCast(wide, hn::InterleaveLower(d, row2, row3));
  const auto pairs01_high = hn::BitCast(wide, hn::InterleaveUpper(d, row0, row1));
  const auto pairs23_high = hn::BitCast(wide, hn::InterleaveUpper(d, row2, row3));
  row0 = hn::BitCast(d, hn::InterleaveLower(wide, pairs01_low, pairs23_low));
  row1 = hn::BitCast(d, hn::InterleaveUpper(wide, pairs01_low, pairs23_low));
  row2 = hn::BitCast(d, hn::InterleaveLower(wide, pairs01_high, pairs23_high));
  row3 = hn::BitCast(d, hn::InterleaveUpper(wide, pairs01_high, pairs23_high));
}

/// What a particle has in an array of `stride` numbers for each, where its record begins at `begin` (read_row).
template <int stride, typename Real>
HWY_INLINE const Real* numbers_of(const Real* array, std::int32_t begin) {
  const std::size_t at = static_cast<std::uint32_t>(begin);
  return array + (stride == pair_record_size ? at : at / pair_record_size * stride);
}

/// Four numbers of each of a vector of particles, from `array` on, whose records begin at `begins`: field by field.
template <int stride>
HWY_INLINE void load_four_fields(const float* array, const std::int32_t* begins, Simd<float>* fields) {
  constexpr int n_lanes = lanes<float>;
  const Tag<float> d;
  const hn::Half<Tag<float>> half;
  const auto block = [&](int lane) HWY_ATTR {
    return hn::LoadU(hn::FixedTag<float, 4>(), numbers_of<stride>(array, begins[lane]));
  };
  Simd<float> rows[4];
  for (int k = 0; k < 4; ++k) {
    if constexpr (n_lanes == 16)
      rows[k] =
          hn::Combine(d, hn::Combine(half, block(k + 12), block(k + 8)), hn::Combine(half, block(k + 4), block(k)));
    else
      rows[k] = hn::Combine(d, block(k + 4), block(k));
  }
  transpose_blocks(rows[0], rows[1], rows[2], rows[3]);
  for (int k = 0; k < 4; ++k) fields[k] = rows[k];
}

// The plain forms of these shuffles warn of a value that is not initialised (GCC 12); with a full mask they are the
// same.

/// The even blocks of four lanes of `low`, then those of `high`.
HWY_INLINE Simd<float> even_blocks(Simd<float> low, Simd<float> high) {
#if HWY_TARGET <= HWY_AVX3
  return Simd<float>{_mm512_maskz_shuffle_f32x4(0xFFFF, low.raw, high.raw, _MM_SHUFFLE(2, 0, 2, 0))};
#else
  return hn::ConcatLowerLower(Tag<float>(), high, low);
#endif
}

/// The odd ones.
HWY_INLINE Simd<float> odd_blocks(Simd<float> low, Simd<float> high) {
#if HWY_TARGET <= HWY_AVX3
  return Simd<float>{_mm512_maskz_shuffle_f32x4(0xFFFF, low.raw, high.raw, _MM_SHUFFLE(3, 1, 3, 1))};
#else
  return hn::ConcatUpperUpper(Tag<float>(), high, low);
#endif
}

/// Eight: half the loads of twice four.
template <int stride>
HWY_INLINE void load_eight_fields(const float* array, const std::int32_t* begins, Simd<float>* fields) {
  constexpr int n_lanes = lanes<float>;
  const Tag<float> d;
  const auto record = [&](int lane) HWY_ATTR {
    return hn::LoadU(hn::FixedTag<float, 8>(), numbers_of<stride>(array, begins[lane]));
  };
  Simd<float> low[4], high[4];  // the first half of the neighbours, and the second
  for (int k = 0; k < 4; ++k) {
    if constexpr (n_lanes == 16) {
      low[k] = hn::Combine(d, record(k + 4), record(k));
      high[k] = hn::Combine(d, record(k + 12), record(k + 8));
    } else {
      low[k] = record(k);
      high[k] = record(k + 4);
    }
  }
  transpose_blocks(low[0], low[1], low[2], low[3]);
  transpose_blocks(high[0], high[1], high[2], high[3]);
  // Row k has field k of four neighbours in its even blocks, field k + 4 of them in its odd ones.
  for (int k = 0; k < 4; ++k) {
    fields[k] = even_blocks(low[k], high[k]);
    fields[k + 4] = odd_blocks(low[k], high[k]);
  }
}

/// Fields [first, first + n) of a vector of particles in an array of `stride` numbers for each: fields[f] holds field
/// first + f of those whose records begin at `begins`.
template <int stride, int n>
HWY_INLINE void load_fields(const float* array, std::ptrdiff_t first, const std::int32_t* begins,
                            Simd<float> (&fields)[padded_fields(n)]) {
  constexpr int n_loaded = padded_fields(n);
  for (int f = 0; f + 8 <= n_loaded; f += 8) load_eight_fields<stride>(array + first + f, begins, fields + f);
  if constexpr (n_loaded % 8 != 0)
    load_four_fields<stride>(array + first + n_loaded - 4, begins, fields + n_loaded - 4);
}

/// Double precision serves studies, not speed: plain gathers.
template <int stride, int n>
HWY_INLINE void load_fields(const double* array, std::ptrdiff_t first, const std::int32_t* begins,
                            Simd<double> (&fields)[padded_fields(n)]) {
  const Tag<double> d;
  const Tag<std::int64_t> di;
  alignas(32) std::int64_t offsets[lanes<double>];
  for (int lane = 0; lane < lanes<double>; ++lane) offsets[lane] = numbers_of<stride>(array, begins[lane]) - array;
  for (int f = 0; f < n; ++f) fields[f] = hn::GatherIndex(d, array + first + f, hn::Load(di, offsets));
}

/// One field of a vector of neighbours.
template <int Dim, typename Real, int field>
HWY_INLINE Simd<Real> load_field(const PairFields<Dim, Real>& fields, const std::int32_t* begins) {
  constexpr int n_together = std::is_same_v<Real, float> ? 4 : 1, first = field / n_together * n_together;
  Simd<Real> loaded[4];
  load_fields<PairFields<Dim, Real>::record_size, n_together>(fields.records.data(), first, begins, loaded);
  return loaded[field - first];
}

/// The sums over the lanes of as many vectors as each has lanes: adding interleaved halves takes 14 shuffles for eight
/// vectors of eight, where one sum after another takes 24.
template <typename D>
HWY_INLINE hn::Vec<D> sum_lanes(D d, const hn::Vec<D>* v) {
  constexpr int n = static_cast<int>(hn::MaxLanes(D()));
  using Real = hn::TFromD<D>;
  static_assert(n * sizeof(Real) == 32);
  const auto add_pairs = [&](hn::Vec<D> a, hn::Vec<D> b)
                             HWY_ATTR { return hn::Add(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b)); };
  const auto add_halves = [&](hn::Vec<D> a, hn::Vec<D> b) HWY_ATTR {
    return hn::Add(hn::ConcatLowerLower(d, b, a), hn::ConcatUpperUpper(d, b, a));
  };
  if constexpr (n == 4) {
    return add_halves(add_pairs(v[0], v[1]), add_pairs(v[2], v[3]));
  } else {
    const hn::Repartition<double, D> wide;
    const auto add_fours = [&](const hn::Vec<D>* four) HWY_ATTR {
      const auto low = hn::BitCast(wide, add_pairs(four[0], four[1])),
                 high = hn::BitCast(wide, add_pairs(four[2], four[3]));
      return hn::Add(hn::BitCast(d, hn::InterleaveLower(wide, low, high)),
                     hn::BitCast(d, hn::InterleaveUpper(wide, low, high)));
    };
    return add_halves(add_fours(v), add_fours(v + 4));
  }
}

template <typename Real>
using HalfTag = hn::CappedTag<Real, pair_lanes<Real> / 2>;

/// Sums over a row in vectors of pair_lanes, then lane k of each sum added to lane k + pair_lanes/2. Unrolled: there
/// are registers for most sums.
template <int n_sums, typename Real, typename Add>
HWY_INLINE void fold_row_of_whole_groups(const NeighbourLists::Row& row, hn::Vec<HalfTag<Real>>* folded,
                                         const Add& add) {
  const HalfTag<Real> half;
  Simd<Real> sums[n_sums];
#pragma GCC unroll 32
  for (int s = 0; s < n_sums; ++s) sums[s] = hn::Zero(Tag<Real>());
  for (std::size_t k = 0; k < row.neighbours.size(); k += pair_lanes<Real>) add(row.padded.data() + k, sums);
#pragma GCC unroll 32
  for (int s = 0; s < n_sums; ++s) folded[s] = hn::Add(hn::LowerHalf(half, sums[s]), hn::UpperHalf(half, sums[s]));
}

/// Sums over every other vector of half as many lanes, from vector `first` on.
template <int n_sums, typename Real, typename Add>
HWY_INLINE void sum_half_groups(const NeighbourLists::Row& row, std::size_t first, hn::Vec<HalfTag<Real>>* out,
                                const Add& add) {
  Simd<Real> sums[n_sums];
#pragma GCC unroll 32
  for (int s = 0; s < n_sums; ++s) sums[s] = hn::Zero(HalfTag<Real>());
  for (std::size_t k = first * lanes<Real>; k < row.neighbours.size(); k += pair_lanes<Real>)
    add(row.padded.data() + k, sums);
#pragma GCC unroll 32
  for (int s = 0; s < n_sums; ++s) out[s] = sums[s];
}

/// The same as the sums over whole groups, folded.
template <int n_sums, typename Real, typename Add>
HWY_INLINE void fold_row_of_half_groups(const NeighbourLists::Row& row, hn::Vec<HalfTag<Real>>* folded,
                                        const Add& add) {
  hn::Vec<HalfTag<Real>> second[n_sums];
  sum_half_groups<n_sums, Real>(row, 0, folded, add);
  sum_half_groups<n_sums, Real>(row, 1, second, add);
#pragma GCC unroll 32
  for (int s = 0; s < n_sums; ++s) folded[s] = hn::Add(folded[s], second[s]);
}

/// Adds up what `add(begins, sums)` adds to `sums`, vectors of lanes, for every vector of neighbours in `row`; vectors
/// of padding alone are left out, as they would add nothing. The same bytes on every machine: sums are folded to half
/// of pair_lanes, then these are summed, whatever the length of a vector. `total` has n_sums entries.
template <int n_sums, typename Real, typename Add>
HWY_INLINE void sum_row(const NeighbourLists::Row& row, Real* total, const Add& add) {
  constexpr int n_half = pair_lanes<Real> / 2, n_padded = (n_sums + n_half - 1) / n_half * n_half;
  const HalfTag<Real> half;
  hn::Vec<HalfTag<Real>> folded[n_padded];
  for (int s = n_sums; s < n_padded; ++s) folded[s] = hn::Zero(half);
  if constexpr (lanes<Real> == pair_lanes<Real>)
    fold_row_of_whole_groups<n_sums, Real>(row, folded, add);
  else
    fold_row_of_half_groups<n_sums, Real>(row, folded, add);
  Real padded[n_padded];
  for (int s = 0; s < n_padded; s += n_half) hn::StoreU(sum_lanes(half, folded + s), half, padded + s);
  std::copy_n(padded, n_sums, total);
}

/// Some of the sums over a row: `add` as for sum_row. It must index its sums by what the compiler knows once it has
/// unrolled loops of fixed length, not by a count that depends on another loop's, else they stay in memory.
template <int n_sums, typename Add>
struct SumGroup {
  static constexpr int n = n_sums;
  const Add& add;
};

template <int n_sums, typename Add>
HWY_INLINE SumGroup<n_sums, Add> sum_group(const Add& add) {
  return {add};
}

/// The sums of all groups one after another, to `total`: with 32 registers in one loop over the row, with 16 in a loop
/// for each group, whose sums they hold then.
template <typename Real, typename... Group>
HWY_INLINE void sum_row_in_groups(const NeighbourLists::Row& row, Real* total, const Group&... group) {
  if constexpr (lanes<Real> == pair_lanes<Real>) {
    const auto add = [&](const std::int32_t* begins, Simd<Real>* sums) HWY_ATTR __attribute__((always_inline)) {
      int at = 0;
      ((group.add(begins, sums + at), at += Group::n), ...);
    };
    sum_row<(Group::n + ...)>(row, total, add);
  } else {
    int at = 0;
    ((sum_row<Group::n>(row, total + at, group.add), at += Group::n), ...);
  }
}

/// Particles whose records the passes over pairs will soon read for the first time come to the caches meanwhile: those
/// of rods do not lie in the order in which the machine would fetch them by itself.
template <bool with_stress, int Dim, typename Real>
HWY_INLINE void fetch_ahead(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, std::size_t i) {
  const std::size_t ahead = std::min(i + lists.look_ahead, lists.size() - 1);
  hwy::Prefetch(fields.record(ahead));
  if constexpr (with_stress) hwy::Prefetch(fields.stress(ahead));
}

/// What every pair needs of its neighbours.
template <int Dim, typename Real>
struct Neighbours {
  Simd<Real> x_ij[Dim], v_ij[Dim], volume, density;

  HWY_INLINE Neighbours(const Real* record_i, const Real* records, const std::int32_t* begins) {
    using Fields = PairFields<Dim, Real>;
    const Tag<Real> d;
    Simd<Real> fields[padded_fields(Fields::n_motion)];
    load_fields<Fields::record_size, Fields::n_motion>(records, 0, begins, fields);
    for (int a = 0; a < Dim; ++a) x_ij[a] = hn::Sub(hn::Set(d, record_i[a]), fields[a]);
    for (int a = 0; a < Dim; ++a)
      v_ij[a] = hn::Sub(hn::Set(d, record_i[Fields::velocity_at + a]), fields[Fields::velocity_at + a]);
    volume = fields[Fields::volume_at];
    density = fields[Fields::density_at];
  }
};

template <int Dim, typename Real>
HWY_INLINE Simd<Real> dot(const Simd<Real> (&a)[Dim], const Simd<Real> (&b)[Dim]) {
  auto sum = hn::Mul(a[0], b[0]);
  for (int k = 1; k < Dim; ++k) sum = hn::MulAdd(a[k], b[k], sum);
  return sum;
}

/// Adds sum V_j w (x_j - x_i) (x) grad_w_ij for a vector of neighbours, `weight` being V_j w F, to packed sums.
template <int Dim, typename Real, typename Pair>
HWY_INLINE void add_position_moment(const Pair& pair, Simd<Real> weight, Simd<Real>* moment) {
  for (int m = 0; m < n_symmetric<Dim>; ++m) {
    const auto [a, b] = symmetric_entry<Dim>(m);
    moment[m] = hn::NegMulAdd(pair.x_ij[a], hn::Mul(weight, pair.x_ij[b]), moment[m]);
  }
}

/// Calls run(std::type_identity<the pair kernel of `type`>).
template <int Dim, typename Real, typename Run>
void with_kernel(KernelType type, const Run& run) {
  switch (type) {
    case KernelType::cubic_spline:
      return run(std::type_identity<CubicSpline<Dim, Real>>{});
    case KernelType::quintic_spline:
      return run(std::type_identity<QuinticSpline<Dim, Real>>{});
    case KernelType::quadratic:
      return run(std::type_identity<Quadratic<Dim, Real>>{});
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace smelt
HWY_AFTER_NAMESPACE();

#endif  // SMELT_PAIR_RECORDS_INL_H
