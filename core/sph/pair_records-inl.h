// How the pair loops read particles, for one instruction set.
#if defined(SMELT_PAIR_RECORDS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SMELT_PAIR_RECORDS_INL_H
#undef SMELT_PAIR_RECORDS_INL_H
#else
#define SMELT_PAIR_RECORDS_INL_H
#endif

#include "core/sph/pair_kernels-inl.h"
#include "core/sph/pair_sums.h"

#include <hwy/highway.h>

#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace smelt {
namespace HWY_NAMESPACE {

/// Turns four vectors of rows (in blocks of four lanes) into four vectors of columns.
HWY_INLINE void transpose_blocks(Simd<float> (&rows)[4]) {
  const Tag<float> d;
  const hn::Repartition<double, Tag<float>> wide;
  const auto pairs01_low = hn::BitCast(wide, hn::InterleaveLower(d, rows[0], rows[1]));
  const auto pairs23_low = hn::BitCast(wide, hn::InterleaveLower(d, rows[2], rows[3]));
  const auto pairs01_high = hn::BitCast(wide, hn::InterleaveUpper(d, rows[0], rows[1]));
  const auto pairs23_high = hn::BitCast(wide, hn::InterleaveUpper(d, rows[2], rows[3]));
  rows[0] = hn::BitCast(d, hn::InterleaveLower(wide, pairs01_low, pairs23_low));
  rows[1] = hn::BitCast(d, hn::InterleaveUpper(wide, pairs01_low, pairs23_low));
  rows[2] = hn::BitCast(d, hn::InterleaveLower(wide, pairs01_high, pairs23_high));
  rows[3] = hn::BitCast(d, hn::InterleaveUpper(wide, pairs01_high, pairs23_high));
}

/// Loads the first n_fields of the records of one vector of neighbours: fields[f] holds field f of each.
template <int n_fields, int stride>
HWY_INLINE void load_records(const float* records, const std::int32_t* index, Simd<float> (&fields)[padded_record(n_fields)]) {
  static_assert(pair_lanes<float> == 8);
  const Tag<float> d;
  const hn::Half<Tag<float>> half;
  const float* at[8];
  for (int lane = 0; lane < 8; ++lane) at[lane] = records + static_cast<std::size_t>(index[lane]) * stride;
  for (int group = 0; group < padded_record(n_fields); group += 4) {
    Simd<float> rows[4];
    for (int k = 0; k < 4; ++k)
      rows[k] = hn::Combine(d, hn::LoadU(half, at[k + 4] + group), hn::LoadU(half, at[k] + group));
    transpose_blocks(rows);
    for (int k = 0; k < 4; ++k) fields[group + k] = rows[k];
  }
}

/// Double precision serves studies, not speed: plain gathers.
template <int n_fields, int stride>
HWY_INLINE void load_records(const double* records, const std::int32_t* index,
                             Simd<double> (&fields)[padded_record(n_fields)]) {
  const Tag<double> d;
  const Tag<std::int64_t> di;
  const auto indices = hn::PromoteTo(di, hn::LoadU(hn::Rebind<std::int32_t, decltype(di)>(), index));
  const auto offsets = hn::Mul(indices, hn::Set(di, stride));
  for (int f = 0; f < n_fields; ++f) fields[f] = hn::GatherIndex(d, records + f, offsets);
}

/// One scalar field of a vector of neighbours.
template <typename Real>
HWY_INLINE Simd<Real> load_scalar(const std::vector<Real>& field, const std::int32_t* index) {
  alignas(32) Real lanes[pair_lanes<Real>];
  for (int lane = 0; lane < pair_lanes<Real>; ++lane) lanes[lane] = field[static_cast<std::size_t>(index[lane])];
  return hn::Load(Tag<Real>(), lanes);
}

template <typename Real>
HWY_INLINE Real sum_lanes(Simd<Real> v) {
  return hn::GetLane(hn::SumOfLanes(Tag<Real>(), v));
}

/// What every pair needs of its neighbours.
template <int Dim, typename Real>
struct Neighbours {
  Simd<Real> x_ij[Dim], v_ij[Dim], volume, density;

  HWY_INLINE Neighbours(const Real* motion_i, const Real* motion, const std::int32_t* index) {
    using Fields = PairFields<Dim, Real>;
    const Tag<Real> d;
    Simd<Real> fields[Fields::motion_stride];
    load_records<2 * Dim + 2, Fields::motion_stride>(motion, index, fields);
    for (int a = 0; a < Dim; ++a) x_ij[a] = hn::Sub(hn::Set(d, motion_i[a]), fields[a]);
    for (int a = 0; a < Dim; ++a)
      v_ij[a] = hn::Sub(hn::Set(d, motion_i[Fields::velocity_at + a]), fields[Fields::velocity_at + a]);
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

/// Calls run(std::type_identity<the pair kernel of `type`>).
template <int Dim, typename Real, typename Run>
void with_kernel(KernelType type, const Run& run) {
  switch (type) {
    case KernelType::cubic_spline: return run(std::type_identity<CubicSpline<Dim, Real>>{});
    case KernelType::quintic_spline: return run(std::type_identity<QuinticSpline<Dim, Real>>{});
    case KernelType::quadratic: return run(std::type_identity<Quadratic<Dim, Real>>{});
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace smelt
HWY_AFTER_NAMESPACE();

#endif  // SMELT_PAIR_RECORDS_INL_H
