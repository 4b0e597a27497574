// The pressure passes for one instruction set; included once per target by pressure_sums.cpp.
#if defined(SMELT_PRESSURE_SUMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SMELT_PRESSURE_SUMS_INL_H
#undef SMELT_PRESSURE_SUMS_INL_H
#else
#define SMELT_PRESSURE_SUMS_INL_H
#endif

#include "core/sph/pair_records-inl.h"
#include "core/sph/particles.h"
#include "core/sph/pressure_sums.h"

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace smelt {
namespace HWY_NAMESPACE {

template <typename PairKernel, int Dim, typename Real>
void pressure_gradient_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, double h,
                            std::span<const std::int32_t> particles, PressureGradientSums<Dim, Real>* sums) {
  const Tag<Real> d;
  const PairKernel kernel(h);
  using Fields = PairFields<Dim, Real>;
  std::vector<std::int32_t> buffer(lists.room());
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const auto i = static_cast<std::size_t>(particles[k]);
    const Real* record_i = fields.record(i);
    // The gradient is first, then the moment.
    const auto add_pairs = [&](const std::int32_t* begins, Simd<Real>* sum) HWY_ATTR __attribute__((always_inline)) {
      const Neighbours<Dim, Real> pair(record_i, fields.records.data(), begins);
      const auto& x_ij = pair.x_ij;
      const auto volume_f = hn::Mul(pair.volume, kernel.gradient_over_r(dot<Dim, Real>(x_ij, x_ij)));
      const auto p_j = load_field<Dim, Real, Fields::pressure_at>(fields, begins);
      const auto p_ji = hn::Sub(p_j, hn::Set(d, record_i[Fields::pressure_at]));
      for (int a = 0; a < Dim; ++a) sum[a] = hn::MulAdd(p_ji, hn::Mul(volume_f, x_ij[a]), sum[a]);
      add_position_moment<Dim, Real>(pair, volume_f, sum + Dim);
    };
    Real total[Dim + n_symmetric<Dim>];
    sum_row<Dim + n_symmetric<Dim>>(fields.read_row(lists, i, buffer.data()), total, add_pairs);
    std::copy_n(total, Dim, sums[k].gradient.begin());
    std::copy_n(total + Dim, n_symmetric<Dim>, sums[k].moment.begin());
  }
}

template <typename PairKernel, int Dim, typename Real>
void pressure_diffusion_sums(const PairFields<Dim, Real>& fields, const std::vector<Real>& gradients,
                             const NeighbourLists& lists, double h, std::size_t begin, std::size_t end, Real* sums) {
  const Tag<Real> d;
  const PairKernel kernel(h);
  constexpr int stride = gradient_stride<Dim>;
  const auto soft = hn::Set(d, static_cast<Real>(0.01 * h * h));
  const auto half = hn::Set(d, Real(0.5));
  std::vector<std::int32_t> buffer(lists.room());
  for (std::size_t i = begin; i < end; ++i) {
    const Real* record_i = fields.record(i);
    const Real* gradient_i = gradients.data() + i * stride;
    const auto add_pairs = [&](const std::int32_t* begins, Simd<Real>* sum) HWY_ATTR __attribute__((always_inline)) {
      const Neighbours<Dim, Real> pair(record_i, fields.records.data(), begins);
      const auto r2 = dot<Dim, Real>(pair.x_ij, pair.x_ij);
      Simd<Real> gradient_j[padded_fields(stride)];  // and the pressure
      load_fields<stride, stride>(gradients.data(), 0, begins, gradient_j);
      Simd<Real> gradient[Dim];
      for (int a = 0; a < Dim; ++a) gradient[a] = hn::Add(hn::Set(d, gradient_i[a]), gradient_j[a]);
      const auto p_ji = hn::Sub(gradient_j[Dim], hn::Set(d, gradient_i[Dim]));
      const auto unexplained = hn::MulAdd(half, dot<Dim, Real>(gradient, pair.x_ij), p_ji);
      const auto weight = hn::Div(hn::Mul(hn::Mul(pair.volume, kernel.gradient_over_r(r2)), r2), hn::Add(r2, soft));
      // F is negative: the sign of a Laplacian.
      sum[0] = hn::NegMulAdd(weight, unexplained, sum[0]);
    };
    Real total[1];
    sum_row<1>(fields.read_row(lists, i, buffer.data()), total, add_pairs);
    sums[i - begin] = 2 * total[0];
  }
}

#define SMELT_INSTANTIATE(Dim, Real, suffix)                                                                       \
  inline void pressure_gradient_sums_##suffix(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,    \
                                              KernelType type, double h, std::span<const std::int32_t> particles,  \
                                              PressureGradientSums<Dim, Real>* sums) {                             \
    with_kernel<Dim, Real>(type, [&](auto kernel) HWY_ATTR {                                                       \
      pressure_gradient_sums<typename decltype(kernel)::type, Dim, Real>(fields, lists, h, particles, sums);       \
    });                                                                                                            \
  }                                                                                                                \
  inline void pressure_diffusion_sums_##suffix(                                                                    \
      const PairFields<Dim, Real>& fields, const std::vector<Real>& gradients, const NeighbourLists& lists,        \
      KernelType type, double h, std::size_t begin, std::size_t end, Real* sums) {                                 \
    with_kernel<Dim, Real>(type, [&](auto kernel) HWY_ATTR {                                                       \
      pressure_diffusion_sums<typename decltype(kernel)::type, Dim, Real>(fields, gradients, lists, h, begin, end, \
                                                                          sums);                                   \
    });                                                                                                            \
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

#endif  // SMELT_PRESSURE_SUMS_INL_H
