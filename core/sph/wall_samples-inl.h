// The sums over samples for one instruction set; included once per target by wall_samples.cpp.
#if defined(SMELT_WALL_SAMPLES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SMELT_WALL_SAMPLES_INL_H
#undef SMELT_WALL_SAMPLES_INL_H
#else
#define SMELT_WALL_SAMPLES_INL_H
#endif

#include "core/sph/wall_samples.h"

#include <hwy/highway.h>

#include <array>

HWY_BEFORE_NAMESPACE();
namespace smelt {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using SampleLanes = hn::CappedTag<float, wall_lanes>;
using SampleSimd = hn::Vec<SampleLanes>;

/// Coefficients of one term for all lanes.
template <int Degree>
HWY_INLINE SampleSimd evaluate(const std::array<float, 9>& p, SampleSimd q) {
  const SampleLanes d;
  SampleSimd value = hn::Set(d, p[Degree]);
  for (int k = Degree; k-- > 0;) value = hn::MulAdd(value, q, hn::Set(d, p[k]));
  return value;
}

/// f(q), f'(q) and f''(q) by Horner's rule.
template <int Degree>
HWY_INLINE void evaluate_with_slopes(const std::array<float, 9>& p, SampleSimd q, SampleSimd& value, SampleSimd& slope,
                                     SampleSimd& curvature) {
  const SampleLanes d;
  value = hn::Set(d, p[Degree]);
  slope = curvature = hn::Zero(d);
  for (int k = Degree; k-- > 0;) {
    curvature = hn::MulAdd(curvature, q, slope);
    slope = hn::MulAdd(slope, q, value);
    value = hn::MulAdd(value, q, hn::Set(d, p[k]));
  }
  curvature = hn::Add(curvature, curvature);
}

/// A kernel's f, f', f'' and N (core/sph/wall_integrals.h) at q = r/h.
struct RadialValues {
  SampleSimd w, w1, w2, ray;
};

template <std::size_t NTerms, int Degree>
HWY_INLINE RadialValues evaluate_terms(const SampleKernel& kernel, SampleSimd q) {
  const SampleLanes d;
  RadialValues sum{hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  for (std::size_t t = 0; t < NTerms; ++t) {
    const auto within = hn::Lt(q, hn::Set(d, kernel.terms[t].radius));
    SampleSimd value, slope, curvature;
    evaluate_with_slopes<Degree>(kernel.terms[t].shape, q, value, slope, curvature);
    sum.w = hn::Add(sum.w, hn::IfThenElseZero(within, value));
    sum.w1 = hn::Add(sum.w1, hn::IfThenElseZero(within, slope));
    sum.w2 = hn::Add(sum.w2, hn::IfThenElseZero(within, curvature));
    sum.ray = hn::Add(sum.ray, hn::IfThenElseZero(within, evaluate<Degree + 3>(kernel.terms[t].ray, q)));
  }
  return sum;
}

HWY_INLINE SampleSimd dot(const SampleSimd (&a)[3], const SampleSimd (&b)[3]) {
  return hn::MulAdd(a[0], b[0], hn::MulAdd(a[1], b[1], hn::Mul(a[2], b[2])));
}

/// Means over a sample's patch to the second order, f + (f''/2 yMy/r^2 + f'/2r (tr M - yMy/r^2)), M the second moment
/// of the patch over its area.
struct PatchMeans {
  SampleSimd w;          ///< of f
  SampleSimd g;          ///< of G = N/r^3
  SampleSimd w1_over_q;  ///< f'/q
};

HWY_INLINE PatchMeans mean_over_patch(SampleSimd q, const RadialValues& at, SampleSimd y_my, SampleSimd trace) {
  const SampleLanes d;
  const SampleSimd half = hn::Set(d, 0.5F), inverse_q = hn::Div(hn::Set(d, 1.0F), q);
  const SampleSimd inverse_r2 = hn::Mul(inverse_q, inverse_q);
  const SampleSimd along = hn::Mul(half, hn::Mul(y_my, inverse_r2)), across = hn::Sub(hn::Mul(half, trace), along);
  PatchMeans mean;
  mean.w1_over_q = hn::Mul(at.w1, inverse_q);
  mean.w = hn::MulAdd(across, mean.w1_over_q, hn::MulAdd(along, at.w2, at.w));
  // G = N/r^3, N' = -f r^2: G'/r = -f/r^2 - 3 N/r^5, G'' = -f'/r + 4 f/r^2 + 12 N/r^5.
  const SampleSimd g = hn::Mul(at.ray, hn::Mul(inverse_r2, inverse_q)), g_over_r2 = hn::Mul(g, inverse_r2);
  const SampleSimd w_over_r2 = hn::Mul(at.w, inverse_r2);
  const SampleSimd g1_over_q = hn::NegMulSub(hn::Set(d, 3.0F), g_over_r2, w_over_r2);
  const SampleSimd g2 =
      hn::MulAdd(hn::Set(d, 12.0F), g_over_r2, hn::MulSub(hn::Set(d, 4.0F), w_over_r2, mean.w1_over_q));
  mean.g = hn::MulAdd(across, g1_over_q, hn::MulAdd(along, g2, g));
  return mean;
}

/// The sums of SampleSums, a lane each, in units of h; of the moment its diagonal, then twice what is off it.
struct LaneSums {
  SampleSimd area, solid, normal[3], first[3], moment[6];

  HWY_INLINE LaneSums() {
    area = solid = hn::Zero(SampleLanes());
    for (auto& v : normal) v = area;
    for (auto& v : first) v = area;
    for (auto& v : moment) v = area;
  }
};

inline SampleSums add_up_lanes(const LaneSums& lanes, double h) {
  const SampleLanes d;
  const auto total = [&](SampleSimd v) HWY_ATTR { return static_cast<double>(hn::GetLane(hn::SumOfLanes(d, v))); };
  SampleSums sums;
  sums.area = total(lanes.area) / h;
  sums.solid = total(lanes.solid);
  for (int a = 0; a < 3; ++a) {
    sums.normal[a] = total(lanes.normal[a]) / h;
    sums.first[a] = total(lanes.first[a]);
    sums.moment(a, a) = sums.solid - total(lanes.moment[a]);
  }
  for (int a = 0, m = 3; a < 3; ++a)
    for (int b = a + 1; b < 3; ++b, ++m) sums.moment(a, b) = sums.moment(b, a) = -0.5 * total(lanes.moment[m]);
  return sums;
}

template <std::size_t NTerms, int Degree>
SampleSums sum_samples(const SampleKernel& kernel, std::span<const float> packed, const Vec3& moved) {
  const SampleLanes d;
  const std::size_t lanes = hn::Lanes(d);
  const double h = kernel.smoothing_length;
  // In units of h.
  const auto inverse_h = static_cast<float>(1.0 / h);
  const SampleSimd scale = hn::Set(d, inverse_h), scale2 = hn::Set(d, inverse_h * inverse_h);
  SampleSimd moved_by[3];
  for (int a = 0; a < 3; ++a) moved_by[a] = hn::Set(d, static_cast<float>(moved[a] / h));
  LaneSums sum;
  // Where vectors are shorter than a group (no machine that smelt runs on), it takes several.
  for (std::size_t k = 0; k < packed.size(); k += wall_group)
    for (std::size_t lane = 0; lane < wall_lanes; lane += lanes) {
      const float* group = packed.data() + k + lane;
      const auto load = [&](int row) HWY_ATTR { return hn::LoadU(d, group + row * static_cast<int>(wall_lanes)); };
      SampleSimd y[3], n[3], m[6];
      for (int a = 0; a < 3; ++a) {
        y[a] = hn::MulSub(load(a), scale, moved_by[a]);
        n[a] = hn::Mul(load(3 + a), scale2);
      }
      for (int a = 0; a < 6; ++a) m[a] = hn::Mul(load(7 + a), scale2);
      const SampleSimd my[3] = {hn::MulAdd(m[0], y[0], hn::MulAdd(m[3], y[1], hn::Mul(m[4], y[2]))),
                                hn::MulAdd(m[3], y[0], hn::MulAdd(m[1], y[1], hn::Mul(m[5], y[2]))),
                                hn::MulAdd(m[4], y[0], hn::MulAdd(m[5], y[1], hn::Mul(m[2], y[2])))};
      // A sample at the particle's own place has no direction: no division by zero.
      const SampleSimd q = hn::Sqrt(hn::Add(dot(y, y), hn::Set(d, 1e-10F)));
      const PatchMeans mean =
          mean_over_patch(q, evaluate_terms<NTerms, Degree>(kernel, q), dot(y, my), hn::Add(m[0], hn::Add(m[1], m[2])));
      const SampleSimd size = hn::Mul(load(6), scale2);
      sum.area = hn::MulAdd(size, mean.w, sum.area);
      sum.solid = hn::NegMulAdd(dot(y, n), mean.g, sum.solid);
      // int y W = (y W + M y W'/r) area
      SampleSimd first_w[3];
      for (int a = 0; a < 3; ++a) {
        first_w[a] = hn::MulAdd(my[a], mean.w1_over_q, hn::Mul(y[a], mean.w));
        sum.normal[a] = hn::MulAdd(n[a], mean.w, sum.normal[a]);
        sum.first[a] = hn::MulAdd(size, first_w[a], sum.first[a]);
        sum.moment[a] = hn::MulAdd(first_w[a], n[a], sum.moment[a]);
      }
      for (int a = 0, k6 = 3; a < 3; ++a)
        for (int b = a + 1; b < 3; ++b, ++k6)
          sum.moment[k6] = hn::MulAdd(first_w[a], n[b], hn::MulAdd(first_w[b], n[a], sum.moment[k6]));
    }
  return add_up_lanes(sum, h);
}

inline SampleSums wall_sample_sums(const SampleKernel& kernel, std::span<const float> packed, const Vec3& moved) {
  switch (kernel.n_terms) {
    case 1:
      return sum_samples<1, 2>(kernel, packed, moved);
    case 2:
      return sum_samples<2, 3>(kernel, packed, moved);
    default:
      return sum_samples<3, 5>(kernel, packed, moved);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace smelt
HWY_AFTER_NAMESPACE();

#endif  // SMELT_WALL_SAMPLES_INL_H
