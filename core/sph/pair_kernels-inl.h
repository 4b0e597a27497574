// The kernels as the pair loops compute them, for one instruction set; the scalar forms are in core/sph/kernel.h.
#if defined(SMELT_PAIR_KERNELS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SMELT_PAIR_KERNELS_INL_H
#undef SMELT_PAIR_KERNELS_INL_H
#else
#define SMELT_PAIR_KERNELS_INL_H
#endif

#include "core/sph/kernel.h"
#include "core/sph/pair_sums.h"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace smelt {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <typename Real>
using Tag = hn::CappedTag<Real, pair_lanes<Real>>;
template <typename Real>
using Simd = hn::Vec<Tag<Real>>;
template <typename Real>
inline constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag<Real>()));

// Each kernel has its constants folded, gradient_over_r = F = (dW/dr)/r and value = W from r^2, both 0 beyond the
// support and finite at r = 0, where lists are padded with the particle itself.

/// The cubic spline, kappa 2.
template <int Dim, typename Real>
struct CubicSpline {
  Real inverse_h;
  Real value_scale;                              ///< sigma
  Real near_slope, near_constant, far_constant;  ///< 9/4, -3 and -3/4 sigma / h^2

  explicit CubicSpline(double h)
      : inverse_h(static_cast<Real>(1.0 / h)), value_scale(static_cast<Real>(Kernel<Dim>(h).value(0.0))) {
    // f(0) = 1 for the cubic spline: 0.25 * 2^3 - 1.
    const double gradient_scale = Kernel<Dim>(h).value(0.0) / (h * h);
    near_slope = static_cast<Real>(2.25 * gradient_scale);
    near_constant = static_cast<Real>(-3.0 * gradient_scale);
    far_constant = static_cast<Real>(-0.75 * gradient_scale);
  }

  /// F = (dW/dr)/r from r^2; 0 beyond 2h, finite at r = 0.
  HWY_INLINE Simd<Real> gradient_over_r(Simd<Real> r2) const {
    const Tag<Real> d;
    const auto q = hn::Mul(hn::Sqrt(r2), hn::Set(d, inverse_h));
    const auto near_branch = hn::MulAdd(q, hn::Set(d, near_slope), hn::Set(d, near_constant));
    const auto a = hn::Max(hn::Sub(hn::Set(d, Real(2)), q), hn::Zero(d));
    const auto far_branch = hn::Div(hn::Mul(hn::Mul(a, a), hn::Set(d, far_constant)), q);
    return hn::IfThenElse(hn::Lt(q, hn::Set(d, Real(1))), near_branch, far_branch);
  }

  /// W from r^2.
  HWY_INLINE Simd<Real> value(Simd<Real> r2) const {
    const Tag<Real> d;
    const auto q = hn::Mul(hn::Sqrt(r2), hn::Set(d, inverse_h));
    const auto a = hn::Max(hn::Sub(hn::Set(d, Real(2)), q), hn::Zero(d));
    const auto b = hn::Max(hn::Sub(hn::Set(d, Real(1)), q), hn::Zero(d));
    const auto a3 = hn::Mul(a, hn::Mul(a, a));
    const auto b3 = hn::Mul(b, hn::Mul(b, b));
    return hn::Mul(hn::Set(d, value_scale), hn::MulSub(a3, hn::Set(d, Real(0.25)), b3));
  }
};

/// The quintic spline, kappa 3.
template <int Dim, typename Real>
struct QuinticSpline {
  Real inverse_h;
  Real value_scale;     ///< sigma
  Real gradient_scale;  ///< sigma / h^2

  explicit QuinticSpline(double h)
      : inverse_h(static_cast<Real>(1.0 / h)),
        value_scale(static_cast<Real>(kernel_normalisation<Dim>(KernelType::quintic_spline) / std::pow(h, Dim))),
        gradient_scale(
            static_cast<Real>(kernel_normalisation<Dim>(KernelType::quintic_spline) / std::pow(h, Dim + 2))) {}

  HWY_INLINE Simd<Real> gradient_over_r(Simd<Real> r2) const {
    const Tag<Real> d;
    const auto q = hn::Mul(hn::Sqrt(r2), hn::Set(d, inverse_h));
    // Below 1 the three powers come to f'/q = -120 + 120 q^2 - 50 q^3.
    const auto near_branch =
        hn::MulAdd(hn::Mul(q, q), hn::MulAdd(q, hn::Set(d, Real(-50)), hn::Set(d, Real(120))), hn::Set(d, Real(-120)));
    const auto a = hn::Max(hn::Sub(hn::Set(d, Real(3)), q), hn::Zero(d));
    const auto b = hn::Max(hn::Sub(hn::Set(d, Real(2)), q), hn::Zero(d));
    const auto a2 = hn::Mul(a, a), b2 = hn::Mul(b, b);
    const auto slope =
        hn::MulAdd(hn::Mul(b2, b2), hn::Set(d, Real(30)), hn::Mul(hn::Mul(a2, a2), hn::Set(d, Real(-5))));
    const auto far_branch = hn::Div(slope, q);
    return hn::Mul(hn::Set(d, gradient_scale), hn::IfThenElse(hn::Lt(q, hn::Set(d, Real(1))), near_branch, far_branch));
  }

  HWY_INLINE Simd<Real> value(Simd<Real> r2) const {
    const Tag<Real> d;
    const auto q = hn::Mul(hn::Sqrt(r2), hn::Set(d, inverse_h));
    const auto power = [&](Real end) HWY_ATTR {
      const auto a = hn::Max(hn::Sub(hn::Set(d, end), q), hn::Zero(d));
      const auto a2 = hn::Mul(a, a);
      return hn::Mul(a, hn::Mul(a2, a2));
    };
    const auto inner = hn::MulAdd(power(1), hn::Set(d, Real(15)), hn::Mul(power(2), hn::Set(d, Real(-6))));
    return hn::Mul(hn::Set(d, value_scale), hn::Add(power(3), inner));
  }
};

/// The quadratic kernel, kappa 2. Its slope does not vanish towards r = 0, so that particles do not clump.
template <int Dim, typename Real>
struct Quadratic {
  Real inverse_h;
  Real value_scale;     ///< 3/16 sigma
  Real gradient_scale;  ///< 3/8 sigma / h^2

  explicit Quadratic(double h)
      : inverse_h(static_cast<Real>(1.0 / h)),
        value_scale(
            static_cast<Real>(3.0 / 16.0 * kernel_normalisation<Dim>(KernelType::quadratic) / std::pow(h, Dim))),
        gradient_scale(
            static_cast<Real>(3.0 / 8.0 * kernel_normalisation<Dim>(KernelType::quadratic) / std::pow(h, Dim + 2))) {}

  HWY_INLINE Simd<Real> gradient_over_r(Simd<Real> r2) const {
    const Tag<Real> d;
    const auto q = hn::Mul(hn::Sqrt(r2), hn::Set(d, inverse_h));
    // f' = 3/8 (q - 2). A pair at one place has no direction and no force: F counts as 0 there, not as infinite.
    const auto slope = hn::Min(hn::Sub(q, hn::Set(d, Real(2))), hn::Zero(d));
    return hn::Mul(hn::Set(d, gradient_scale), hn::IfThenElseZero(hn::Gt(q, hn::Zero(d)), hn::Div(slope, q)));
  }

  HWY_INLINE Simd<Real> value(Simd<Real> r2) const {
    const Tag<Real> d;
    const auto q = hn::Mul(hn::Sqrt(r2), hn::Set(d, inverse_h));
    const auto a = hn::Max(hn::Sub(hn::Set(d, Real(2)), q), hn::Zero(d));
    return hn::Mul(hn::Set(d, value_scale), hn::Mul(a, a));
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace smelt
HWY_AFTER_NAMESPACE();

#endif  // SMELT_PAIR_KERNELS_INL_H
