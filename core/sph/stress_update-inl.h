// The stress of many particles over one step, for one instruction set; included once per target by stress_update.cpp.
#if defined(SMELT_STRESS_UPDATE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SMELT_STRESS_UPDATE_INL_H
#undef SMELT_STRESS_UPDATE_INL_H
#else
#define SMELT_STRESS_UPDATE_INL_H
#endif

#include "core/sph/gradient_correction.h"
#include "core/sph/stress_update.h"

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace smelt {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using StressTag = hn::CappedTag<double, 8>;
using StressVec = hn::Vec<StressTag>;
using StressMask = hn::Mask<StressTag>;

/// The SMD law of a vector of particles.
class FlowCurves {
 public:
  FlowCurves(StressVec yield_stress, StressVec consistency, StressVec index, StressVec rest_viscosity)
      : yield_stress_(yield_stress), consistency_(consistency), index_(index) {
    const StressTag d;
    yields_ = hn::Gt(yield_stress, hn::Zero(d));
    steepness_ = hn::IfThenElseZero(yields_, hn::Div(rest_viscosity, yield_stress));
    is_root_ = hn::Eq(index, hn::Set(d, 0.5));
    is_power_ = hn::And(hn::Ne(index, hn::Set(d, 1.0)), hn::Not(is_root_));
  }

  /// tau(y) and d tau/dy for y > 0.
  HWY_INLINE void evaluate(StressVec y, StressVec& stress, StressVec& slope) const {
    const StressTag d;
    const auto one = hn::Set(d, 1.0);
    const auto viscous = hn::Mul(consistency_, power(y));
    const auto plastic = hn::Add(yield_stress_, viscous);
    const auto viscous_slope = hn::Div(hn::Mul(index_, viscous), y);
    // 1 - exp(-eta0 y/tau0), which beyond 40 is 1 but for a rounding.
    const auto exponent = hn::Mul(steepness_, y);
    const auto rises = hn::And(yields_, hn::Lt(exponent, hn::Set(d, 40.0)));
    auto rise = one;
    if (!hn::AllFalse(d, rises))
      rise = hn::IfThenElse(rises, hn::Neg(hn::CallExpm1(d, hn::Neg(hn::IfThenElseZero(rises, exponent)))), one);
    stress = hn::Mul(rise, plastic);
    slope = hn::MulAdd(rise, viscous_slope, hn::Mul(hn::Mul(steepness_, hn::Sub(one, rise)), plastic));
  }

 private:
  /// y^n; square roots, which most viscoplastic scenes have ([P 6.1]: n = 1/2), are kept fast.
  HWY_INLINE StressVec power(StressVec y) const {
    const StressTag d;
    auto result = y;
    if (!hn::AllFalse(d, is_root_)) result = hn::IfThenElse(is_root_, hn::Sqrt(y), result);
    if (!hn::AllFalse(d, is_power_))
      result = hn::IfThenElse(is_power_, hn::CallExp(d, hn::Mul(index_, hn::CallLog(d, y))), result);
    return result;
  }

  StressVec yield_stress_, consistency_, index_, steepness_;
  StressMask yields_, is_root_, is_power_;
};

/// relaxed_shear_rate of a vector of particles; `unsolved` are those for which no root was found. Newton's method, and
/// bisection where that leaves the bounds.
HWY_INLINE StressVec relaxed_shear_rates(const FlowCurves& curves, StressVec rest_viscosity, StressVec modulus_dt,
                                         StressVec trial, StressVec guess, StressMask& unsolved) {
  const StressTag d;
  const auto zero = hn::Zero(d);
  unsolved = hn::Not(hn::Le(trial, zero));
  auto result = zero;
  // tau >= 0 bounds the root from above by the rate at which the spring alone would unload.
  auto lower = zero, upper = hn::Div(trial, modulus_dt);
  const auto settle = [&](StressMask found, StressVec y) HWY_ATTR {
    found = hn::And(unsolved, found);
    result = hn::IfThenElse(found, y, result);
    unsolved = hn::And(unsolved, hn::Not(found));
  };
  const auto within = [&](StressVec y) HWY_ATTR { return hn::And(hn::Gt(y, lower), hn::Lt(y, upper)); };
  const auto at_rest = hn::Min(upper, hn::Div(trial, hn::Add(modulus_dt, rest_viscosity)));
  auto y = hn::IfThenElse(within(guess), guess, at_rest);
  y = hn::IfThenElse(hn::Gt(y, zero), y, hn::Mul(hn::Set(d, 0.5), upper));
  const auto tolerance = hn::Mul(hn::Set(d, 1e-10), trial);
  for (int iteration = 0; iteration < 200 && !hn::AllFalse(d, unsolved); ++iteration) {
    StressVec stress, slope;
    curves.evaluate(y, stress, slope);
    const auto residual = hn::Sub(hn::MulAdd(modulus_dt, y, stress), trial);
    settle(hn::Le(hn::Abs(residual), tolerance), y);
    const auto above = hn::Gt(residual, zero);
    upper = hn::IfThenElse(above, y, upper);
    lower = hn::IfThenElse(above, lower, y);
    const auto newton = hn::Sub(y, hn::Div(residual, hn::Add(slope, modulus_dt)));
    // The error goes down by its square, times what the curve bends by over y: 40 at most where it matters.
    const auto step = hn::Abs(hn::Sub(newton, y));
    settle(hn::And(hn::Le(step, hn::Mul(hn::Set(d, 1e-6), y)), hn::Gt(newton, zero)), newton);
    // The knee at the yield stress throws Newton far off now and then: bisect, in the logarithm once there is a scale.
    const bool bisects = iteration >= 12 && iteration % 2 != 0;
    const auto inside = within(newton);
    if (!bisects && hn::AllTrue(d, inside)) {
      y = newton;
    } else {
      const auto middle =
          hn::IfThenElse(hn::Gt(lower, zero), hn::Sqrt(hn::Mul(lower, upper)), hn::Mul(hn::Set(d, 0.1), upper));
      y = bisects ? middle : hn::IfThenElse(inside, newton, middle);
    }
    settle(hn::Le(hn::Sub(upper, lower), hn::Mul(hn::Set(d, 1e-15), upper)), y);
  }
  return result;
}

/// A Dim x Dim matrix of each of a vector of particles.
template <int Dim>
struct Matrices {
  StressVec entry[Dim][Dim];

  static HWY_INLINE Matrices load(const std::array<typename StressBlock<Dim>::Field, Dim * Dim>& fields,
                                  std::size_t k) {
    Matrices m;
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) m.entry[a][b] = hn::Load(StressTag(), fields[a * Dim + b].data() + k);
    return m;
  }
  static HWY_INLINE Matrices
  load_symmetric(const std::array<typename StressBlock<Dim>::Field, n_symmetric<Dim>>& fields, std::size_t k) {
    Matrices m;
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b)
        m.entry[a][b] = hn::Load(StressTag(), fields[symmetric_index<Dim>(a, b)].data() + k);
    return m;
  }
  HWY_INLINE void store(std::array<typename StressBlock<Dim>::Field, Dim * Dim>& fields, std::size_t k) const {
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) hn::Store(entry[a][b], StressTag(), fields[a * Dim + b].data() + k);
  }

  HWY_INLINE Matrices operator*(const Matrices& right) const {
    Matrices product;
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) {
        auto sum = hn::Mul(entry[a][0], right.entry[0][b]);
        for (int c = 1; c < Dim; ++c) sum = hn::MulAdd(entry[a][c], right.entry[c][b], sum);
        product.entry[a][b] = sum;
      }
    return product;
  }
  HWY_INLINE Matrices transpose() const {
    Matrices flipped;
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) flipped.entry[a][b] = entry[b][a];
    return flipped;
  }
  /// sqrt(tr(M M^T)/2).
  HWY_INLINE StressVec magnitude() const {
    auto sum = hn::Zero(StressTag());
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) sum = hn::MulAdd(entry[a][b], entry[a][b], sum);
    return hn::Sqrt(hn::Mul(hn::Set(StressTag(), 0.5), sum));
  }
};

/// Rotation over a step with constant velocity gradient: (1 - H)^-1 (1 + H) of the skew H = W dt/2, orthogonal to
/// rounding. As H^3 = -|H|^2 H with |H|^2 = H:H/2, it is 1 + 2 (H + H^2)/(1 + |H|^2).
template <int Dim>
HWY_INLINE Matrices<Dim> step_rotation(const Matrices<Dim>& gradient, double dt) {
  const StressTag d;
  const auto one = hn::Set(d, 1.0);
  Matrices<Dim> half_spin;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b)
      half_spin.entry[a][b] = hn::Mul(hn::Set(d, 0.25 * dt), hn::Sub(gradient.entry[a][b], gradient.entry[b][a]));
  auto norm = hn::Zero(d);
  for (int a = 0; a < Dim; ++a)
    for (int b = a + 1; b < Dim; ++b) norm = hn::MulAdd(half_spin.entry[a][b], half_spin.entry[a][b], norm);
  const auto scale = hn::Div(hn::Set(d, 2.0), hn::Add(one, norm));
  const Matrices<Dim> square = half_spin * half_spin;
  Matrices<Dim> rotation;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b)
      rotation.entry[a][b] =
          hn::MulAdd(scale, hn::Add(half_spin.entry[a][b], square.entry[a][b]), a == b ? one : hn::Zero(d));
  return rotation;
}

/// Calls run(first) for each vector of particles of the block.
template <int Dim, typename Run>
HWY_INLINE void for_each_vector(const StressBlock<Dim>& block, const Run& run) {
  for (std::size_t k = 0; k < block.size; k += hn::Lanes(StressTag())) run(k);
}

/// Inverts the moments whose eigenvalues all exceed smallest_trusted_moment, and leaves 0 for the others, which are
/// returned, particle k as bit k.
template <int Dim>
std::uint64_t invert_moments(StressBlock<Dim>& block) {
  static_assert(StressBlock<Dim>::capacity < 64);
  const StressTag d;
  const auto zero = hn::Zero(d);
  std::uint64_t thin = 0;
  for_each_vector(block, [&](std::size_t k) HWY_ATTR {
    const Matrices<Dim> moment = Matrices<Dim>::load_symmetric(block.moment, k);
    const auto& m = moment.entry;
    const auto minor = [](StressVec p, StressVec q, StressVec r, StressVec s)
                           HWY_ATTR { return hn::Sub(hn::Mul(p, q), hn::Mul(r, s)); };
    // Sylvester's criterion, as eigenvalues_exceed has it.
    const auto least = hn::Set(d, smallest_trusted_moment);
    const auto a = hn::Sub(m[0][0], least);
    auto trusted = hn::Gt(a, zero);
    Matrices<Dim> inverse;
    if constexpr (Dim == 1) {
      inverse.entry[0][0] = hn::Div(hn::Set(d, 1.0), m[0][0]);
    } else {
      const auto b = hn::Sub(m[1][1], least);
      const auto ab = minor(a, b, m[0][1], m[0][1]);
      trusted = hn::And(trusted, hn::Gt(ab, zero));
      if constexpr (Dim == 2) {
        const auto scale = hn::Div(hn::Set(d, 1.0), minor(m[0][0], m[1][1], m[0][1], m[0][1]));
        inverse.entry[0][0] = hn::Mul(scale, m[1][1]);
        inverse.entry[1][1] = hn::Mul(scale, m[0][0]);
        inverse.entry[0][1] = inverse.entry[1][0] = hn::Neg(hn::Mul(scale, m[0][1]));
      } else {
        const auto c = hn::Sub(m[2][2], least);
        const auto determinant = hn::Add(hn::Sub(hn::Mul(c, ab), hn::Mul(m[1][2], minor(a, m[1][2], m[0][1], m[0][2]))),
                                         hn::Mul(m[0][2], minor(m[0][1], m[1][2], b, m[0][2])));
        trusted = hn::And(trusted, hn::Gt(determinant, zero));
        // Cofactors over the determinant.
        for (int row = 0; row < 3; ++row)
          for (int column = row; column < 3; ++column) {
            const int r1 = (row + 1) % 3, r2 = (row + 2) % 3, c1 = (column + 1) % 3, c2 = (column + 2) % 3;
            inverse.entry[row][column] = minor(m[r1][c1], m[r2][c2], m[r1][c2], m[r2][c1]);
          }
        const auto whole = hn::MulAdd(m[0][2], inverse.entry[0][2],
                                      hn::MulAdd(m[0][1], inverse.entry[0][1], hn::Mul(m[0][0], inverse.entry[0][0])));
        const auto scale = hn::Div(hn::Set(d, 1.0), whole);
        for (int row = 0; row < 3; ++row)
          for (int column = row; column < 3; ++column)
            inverse.entry[column][row] = inverse.entry[row][column] = hn::Mul(scale, inverse.entry[row][column]);
      }
    }
    for (auto& row : inverse.entry)
      for (auto& entry : row) entry = hn::IfThenElseZero(trusted, entry);
    inverse.store(block.correction, k);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::AndNot(trusted, hn::FirstN(d, block.size - k)), bits);
    thin |= std::uint64_t{bits[0]} << k;
  });
  return thin;
}

template <int Dim>
void correct_gradients(StressBlock<Dim>& block) {
  for_each_vector(block, [&](std::size_t k) HWY_ATTR {
    (Matrices<Dim>::load(block.bare_gradient, k) * Matrices<Dim>::load(block.correction, k)).store(block.gradient, k);
  });
}

template <int Dim>
void correct_stresses(StressBlock<Dim>& block) {
  for_each_vector(block, [&](std::size_t k) HWY_ATTR {
    (Matrices<Dim>::load_symmetric(block.stress, k) * Matrices<Dim>::load(block.correction, k))
        .store(block.corrected_stress, k);
  });
}

/// Returns the first particle whose shear rate was not found, or -1.
template <int Dim>
std::ptrdiff_t relax_stresses(double dt, StressBlock<Dim>& block) {
  const StressTag d;
  const auto zero = hn::Zero(d);
  std::ptrdiff_t first_unsolved = -1;
  for_each_vector(block, [&](std::size_t k) HWY_ATTR {
    const auto load = [&](const typename StressBlock<Dim>::Field& field)
                          HWY_ATTR { return hn::Load(d, field.data() + k); };
    const Matrices<Dim> gradient = Matrices<Dim>::load(block.gradient, k);
    const Matrices<Dim> before = Matrices<Dim>::load_symmetric(block.stress, k);
    const Matrices<Dim> rotation = step_rotation<Dim>(gradient, dt);
    Matrices<Dim> trial = rotation * before * rotation.transpose();
    const auto modulus_dt = hn::Mul(load(block.modulus), hn::Set(d, dt));
    auto trace = gradient.entry[0][0];
    for (int a = 1; a < Dim; ++a) trace = hn::Add(trace, gradient.entry[a][a]);
    const auto mean = hn::Mul(trace, hn::Set(d, 2.0 / Dim));
    for (int a = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b) {
        auto rate = hn::Add(gradient.entry[a][b], gradient.entry[b][a]);
        if (a == b) rate = hn::Sub(rate, mean);
        trial.entry[a][b] = trial.entry[b][a] = hn::MulAdd(modulus_dt, rate, trial.entry[a][b]);
      }

    const auto magnitude = trial.magnitude();
    const auto rest_viscosity = load(block.rest_viscosity), old_viscosity = load(block.viscosity);
    const auto guess = hn::IfThenElseZero(hn::Gt(old_viscosity, zero), hn::Div(before.magnitude(), old_viscosity));
    const FlowCurves curves(load(block.yield_stress), load(block.consistency), load(block.index), rest_viscosity);
    StressMask unsolved;
    const auto rate = relaxed_shear_rates(curves, rest_viscosity, modulus_dt, magnitude, guess, unsolved);
    const std::ptrdiff_t lane = hn::FindFirstTrue(d, hn::And(unsolved, hn::FirstN(d, block.size - k)));
    if (lane >= 0 && first_unsolved < 0) first_unsolved = static_cast<std::ptrdiff_t>(k) + lane;
    const auto relaxed = hn::NegMulAdd(modulus_dt, rate, magnitude);
    const auto ratio = hn::IfThenElseZero(hn::Gt(magnitude, zero), hn::Div(relaxed, magnitude));
    for (int m = 0; m < n_symmetric<Dim>; ++m) {
      const auto [a, b] = symmetric_entry<Dim>(m);
      hn::Store(hn::Mul(ratio, trial.entry[a][b]), d, block.stress[m].data() + k);
    }
    hn::Store(hn::IfThenElse(hn::Gt(rate, zero), hn::Div(relaxed, rate), rest_viscosity), d,
              block.viscosity.data() + k);
  });
  return first_unsolved;
}

/// Of one particle; less than 0 where no root was found.
inline double relaxed_shear_rate(const FlowCurve& curve, double modulus_dt, double trial_stress, double guess) {
  const StressTag d;
  const auto rest_viscosity = hn::Set(d, curve.rest_viscosity);
  const FlowCurves curves(hn::Set(d, curve.yield_stress), hn::Set(d, curve.consistency), hn::Set(d, curve.index),
                          rest_viscosity);
  StressMask unsolved;
  const auto rate = relaxed_shear_rates(curves, rest_viscosity, hn::Set(d, modulus_dt), hn::Set(d, trial_stress),
                                        hn::Set(d, guess), unsolved);
  return hn::AllFalse(d, unsolved) ? hn::GetLane(rate) : -1.0;
}

// Highway's tables hold plain functions: one for each dimension.
#define SMELT_INSTANTIATE(Dim)                                                     \
  inline std::uint64_t invert_moments_##Dim(StressBlock<Dim>& block) {             \
    return HWY_NAMESPACE::invert_moments<Dim>(block);                              \
  }                                                                                \
  inline void correct_gradients_##Dim(StressBlock<Dim>& block) {                   \
    HWY_NAMESPACE::correct_gradients<Dim>(block);                                  \
  }                                                                                \
  inline void correct_stresses_##Dim(StressBlock<Dim>& block) {                    \
    HWY_NAMESPACE::correct_stresses<Dim>(block);                                   \
  }                                                                                \
  inline std::ptrdiff_t relax_stresses_##Dim(double dt, StressBlock<Dim>& block) { \
    return HWY_NAMESPACE::relax_stresses<Dim>(dt, block);                          \
  }
SMELT_INSTANTIATE(1)
SMELT_INSTANTIATE(2)
SMELT_INSTANTIATE(3)
#undef SMELT_INSTANTIATE

}  // namespace HWY_NAMESPACE
}  // namespace smelt
HWY_AFTER_NAMESPACE();

#endif  // SMELT_STRESS_UPDATE_INL_H
