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
HWY_INLINE void evaluate_with_slopes(const std::array<float, 9>& p, SampleSimd q, SampleSimd& value, SampleSimd& slope, SampleSimd& curvature) {
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

template <std::size_t NTerms, int Degree>
SampleSums sum_samples(const SampleKernel& kernel, std::span<const float> packed, const Vec3& moved) {
  const SampleLanes d;
  const std::size_t lanes = hn::Lanes(d);
  const double h = kernel.smoothing_length;
  const auto& terms = kernel.terms;
  // In units of h.
  const auto inverse_h = static_cast<float>(1.0 / h);
  const SampleSimd scale = hn::Set(d, inverse_h), scale2 = hn::Set(d, inverse_h * inverse_h);
  SampleSimd moved_by[3];
  for (int a = 0; a < 3; ++a) moved_by[a] = hn::Set(d, static_cast<float>(moved[a] / h));
  SampleSimd area = hn::Zero(d), solid = hn::Zero(d), normal[3], first[3], moment[6];
  for (auto& v : normal) v = hn::Zero(d);
  for (auto& v : first) v = hn::Zero(d);
  for (auto& v : moment) v = hn::Zero(d);
  // Where vectors are shorter than a group (no machine that smelt runs on), it takes several.
  for (std::size_t k = 0; k < packed.size(); k += wall_group)
    for (std::size_t lane = 0; lane < wall_lanes; lane += lanes) {
    const float* group = packed.data() + k + lane;
    const auto load = [&](int row) HWY_ATTR { return hn::LoadU(d, group + row * static_cast<int>(wall_lanes)); };
    SampleSimd y[3], n[3];
    for (int a = 0; a < 3; ++a) {
      y[a] = hn::MulSub(load(a), scale, moved_by[a]);
      n[a] = hn::Mul(load(3 + a), scale2);
    }
    // A sample at the particle's own place has no direction: no division by zero.
    const SampleSimd r2 = hn::MulAdd(y[0], y[0], hn::MulAdd(y[1], y[1], hn::MulAdd(y[2], y[2], hn::Set(d, 1e-10F))));
    const SampleSimd q = hn::Sqrt(r2);
    SampleSimd w = hn::Zero(d), w1 = hn::Zero(d), w2 = hn::Zero(d), ray = hn::Zero(d);
    for (std::size_t t = 0; t < NTerms; ++t) {
      const auto within = hn::Lt(q, hn::Set(d, terms[t].radius));
      SampleSimd value, slope, curvature;
      evaluate_with_slopes<Degree>(terms[t].shape, q, value, slope, curvature);
      w = hn::Add(w, hn::IfThenElseZero(within, value));
      w1 = hn::Add(w1, hn::IfThenElseZero(within, slope));
      w2 = hn::Add(w2, hn::IfThenElseZero(within, curvature));
      ray = hn::Add(ray, hn::IfThenElseZero(within, evaluate<Degree + 3>(terms[t].ray, q)));
    }
    // My, and how much of the mean's two terms there is.
    SampleSimd m[6], my[3];
    for (int a = 0; a < 6; ++a) m[a] = hn::Mul(load(7 + a), scale2);
    my[0] = hn::MulAdd(m[0], y[0], hn::MulAdd(m[3], y[1], hn::Mul(m[4], y[2])));
    my[1] = hn::MulAdd(m[3], y[0], hn::MulAdd(m[1], y[1], hn::Mul(m[5], y[2])));
    my[2] = hn::MulAdd(m[4], y[0], hn::MulAdd(m[5], y[1], hn::Mul(m[2], y[2])));
    const SampleSimd half = hn::Set(d, 0.5F);
    const SampleSimd inverse_q = hn::Div(hn::Set(d, 1.0F), q);
    const SampleSimd inverse_r2 = hn::Mul(inverse_q, inverse_q);
    const SampleSimd along = hn::Mul(half, hn::Mul(hn::MulAdd(y[0], my[0], hn::MulAdd(y[1], my[1], hn::Mul(y[2], my[2]))), inverse_r2));
    const SampleSimd across = hn::NegMulAdd(hn::Set(d, 1.0F), along, hn::Mul(half, hn::Add(m[0], hn::Add(m[1], m[2]))));
    const SampleSimd w1_over_q = hn::Mul(w1, inverse_q);
    const SampleSimd mean_w = hn::MulAdd(across, w1_over_q, hn::MulAdd(along, w2, w));
    // G = N/r^3, N' = -f r^2: G'/r = -f/r^2 - 3 N/r^5, G'' = -f'/r + 4 f/r^2 + 12 N/r^5.
    const SampleSimd g = hn::Mul(ray, hn::Mul(inverse_r2, inverse_q)), g_over_r2 = hn::Mul(g, inverse_r2);
    const SampleSimd w_over_r2 = hn::Mul(w, inverse_r2);
    const SampleSimd g1_over_q = hn::NegMulSub(hn::Set(d, 3.0F), g_over_r2, w_over_r2);
    const SampleSimd g2 = hn::MulAdd(hn::Set(d, 12.0F), g_over_r2, hn::MulSub(hn::Set(d, 4.0F), w_over_r2, w1_over_q));
    const SampleSimd mean_g = hn::MulAdd(across, g1_over_q, hn::MulAdd(along, g2, g));

    const SampleSimd size = hn::Mul(load(6), scale2);
    area = hn::MulAdd(size, mean_w, area);
    const SampleSimd facing = hn::MulAdd(y[0], n[0], hn::MulAdd(y[1], n[1], hn::Mul(y[2], n[2])));
    solid = hn::NegMulAdd(facing, mean_g, solid);
    // int y W = (y W + M y W'/r) area
    SampleSimd first_w[3];
    for (int a = 0; a < 3; ++a) {
      first_w[a] = hn::MulAdd(my[a], w1_over_q, hn::Mul(y[a], mean_w));
      normal[a] = hn::MulAdd(n[a], mean_w, normal[a]);
      first[a] = hn::MulAdd(size, first_w[a], first[a]);
      moment[a] = hn::MulAdd(first_w[a], n[a], moment[a]);
    }
    for (int a = 0, k6 = 3; a < 3; ++a)
      for (int b = a + 1; b < 3; ++b, ++k6) moment[k6] = hn::MulAdd(first_w[a], n[b], hn::MulAdd(first_w[b], n[a], moment[k6]));
  }
  const auto total = [&](SampleSimd v) HWY_ATTR { return static_cast<double>(hn::GetLane(hn::SumOfLanes(d, v))); };
  SampleSums sums;
  sums.area = total(area) / h;
  sums.solid = total(solid);
  for (int a = 0; a < 3; ++a) {
    sums.normal[a] = total(normal[a]) / h;
    sums.first[a] = total(first[a]);
    sums.moment(a, a) = sums.solid - total(moment[a]);
  }
  for (int a = 0, m = 3; a < 3; ++a)
    for (int b = a + 1; b < 3; ++b, ++m) sums.moment(a, b) = sums.moment(b, a) = -0.5 * total(moment[m]);
  return sums;
}

inline SampleSums wall_sample_sums(const SampleKernel& kernel, std::span<const float> packed, const Vec3& moved) {
  switch (kernel.n_terms) {
    case 1: return sum_samples<1, 2>(kernel, packed, moved);
    case 2: return sum_samples<2, 3>(kernel, packed, moved);
    default: return sum_samples<3, 5>(kernel, packed, moved);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace smelt
HWY_AFTER_NAMESPACE();

#endif  // SMELT_WALL_SAMPLES_INL_H
