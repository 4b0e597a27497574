// Compiled once for every instruction set, as pair_sums.cpp is.
#include "core/sph/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/sph/stress_update.cpp"
// clang-format off
#include <hwy/foreach_target.h>  // must come before highway.h

#include "core/sph/stress_update-inl.h"
// clang-format on

#if HWY_ONCE
#include "core/error.h"

#include <bit>
#include <cmath>
#include <string>

namespace smelt {

namespace {

template <int Dim>
double magnitude(const Mat<Dim>& symmetric) {
  return std::sqrt(0.5 * symmetric.squaredNorm());
}

}  // namespace

template <int Dim>
double stress_magnitude(const Symmetric<Dim>& stress) {
  return magnitude<Dim>(to_matrix<Dim>(stress));
}

template <int Dim>
StressState<Dim> instant_stress(const FlowCurve& curve, const Mat<Dim>& velocity_gradient) {
  const Mat<Dim> strain_rate = velocity_gradient + velocity_gradient.transpose();
  const double eta = viscosity(curve, magnitude<Dim>(strain_rate));
  return {to_symmetric<Dim>(eta * strain_rate), eta};
}

template <int Dim>
void follow_strain_rates(StressBlock<Dim>& block) {
  for (std::size_t k = 0; k < block.size; ++k) {
    Mat<Dim> gradient;
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) gradient(a, b) = block.gradient[a * Dim + b][k];
    const StressState<Dim> now = instant_stress<Dim>(block.curve(k), gradient);
    for (int m = 0; m < n_symmetric<Dim>; ++m) block.stress[m][k] = now.stress[m];
    block.viscosity[k] = now.viscosity;
  }
}

namespace {

[[noreturn]] void fail_to_relax(const FlowCurve& curve, double modulus_dt, const std::string& of) {
  throw InternalError(fmt::format("relaxed stress: no shear rate for {}, G dt {} Pa s, tau0 {}, K {}, n {}, eta0 {}",
                                  of, modulus_dt, curve.yield_stress, curve.consistency, curve.index,
                                  curve.rest_viscosity));
}

template <int Dim>
[[noreturn]] void fail_to_relax(double dt, const StressBlock<Dim>& block, std::size_t k) {
  double rate2 = 0.0;
  for (const auto& entry : block.gradient) rate2 += entry[k] * entry[k];
  fail_to_relax(block.curve(k), block.modulus[k] * dt, fmt::format("a velocity gradient of {} 1/s", std::sqrt(rate2)));
}

/// Those with too few neighbours along some axis, one by one.
template <int Dim>
void correct_thin(std::uint64_t thin, StressBlock<Dim>& block) {
  for (; thin != 0; thin &= thin - 1) {
    const auto k = static_cast<std::size_t>(std::countr_zero(thin));
    Symmetric<Dim> moment;
    for (std::size_t m = 0; m < n_symmetric<Dim>; ++m) moment[m] = block.moment[m][k];
    block.set_correction(k, compute_gradient_correction<Dim>(to_matrix<Dim>(moment)));
  }
}

}  // namespace

HWY_EXPORT(relaxed_shear_rate);

double relaxed_shear_rate(const FlowCurve& curve, double modulus_dt, double trial_stress, double guess) {
  const double rate = HWY_DYNAMIC_DISPATCH(relaxed_shear_rate)(curve, modulus_dt, trial_stress, guess);
  if (rate < 0.0) fail_to_relax(curve, modulus_dt, fmt::format("a trial stress of {} Pa", trial_stress));
  return rate;
}

#define SMELT_DISPATCH(Dim)                                                                \
  HWY_EXPORT(invert_moments_##Dim);                                                        \
  HWY_EXPORT(correct_gradients_##Dim);                                                     \
  HWY_EXPORT(correct_stresses_##Dim);                                                      \
  HWY_EXPORT(relax_stresses_##Dim);                                                        \
  template <>                                                                              \
  void invert_moments<Dim>(StressBlock<Dim> & block) {                                     \
    correct_thin<Dim>(HWY_DYNAMIC_DISPATCH(invert_moments_##Dim)(block), block);           \
  }                                                                                        \
  template <>                                                                              \
  void correct_gradients<Dim>(StressBlock<Dim> & block) {                                  \
    HWY_DYNAMIC_DISPATCH(correct_gradients_##Dim)(block);                                  \
  }                                                                                        \
  template <>                                                                              \
  void correct_stresses<Dim>(StressBlock<Dim> & block) {                                   \
    HWY_DYNAMIC_DISPATCH(correct_stresses_##Dim)(block);                                   \
  }                                                                                        \
  template <>                                                                              \
  void relax_stresses<Dim>(double dt, StressBlock<Dim>& block) {                           \
    const std::ptrdiff_t unsolved = HWY_DYNAMIC_DISPATCH(relax_stresses_##Dim)(dt, block); \
    if (unsolved >= 0) fail_to_relax<Dim>(dt, block, static_cast<std::size_t>(unsolved));  \
  }
SMELT_DISPATCH(1)
SMELT_DISPATCH(2)
SMELT_DISPATCH(3)
#undef SMELT_DISPATCH

template <int Dim>
StressState<Dim> relaxed_stress(const FlowCurve& curve, double shear_modulus, double dt,
                                const Mat<Dim>& velocity_gradient, const StressState<Dim>& before) {
  StressBlock<Dim> block{};
  block.size = 1;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) block.gradient[a * Dim + b][0] = velocity_gradient(a, b);
  for (int m = 0; m < n_symmetric<Dim>; ++m) block.stress[m][0] = before.stress[m];
  block.viscosity[0] = before.viscosity;
  block.set_curve(0, curve);
  block.modulus[0] = shear_modulus;
  relax_stresses<Dim>(dt, block);
  StressState<Dim> after{Symmetric<Dim>::Zero(), block.viscosity[0]};
  for (int m = 0; m < n_symmetric<Dim>; ++m) after.stress[m] = block.stress[m][0];
  return after;
}

#define SMELT_INSTANTIATE(Dim)                                                                     \
  template void follow_strain_rates<Dim>(StressBlock<Dim>&);                                       \
  template double stress_magnitude<Dim>(const Symmetric<Dim>&);                                    \
  template StressState<Dim> instant_stress<Dim>(const FlowCurve&, const Mat<Dim>&);                \
  template StressState<Dim> relaxed_stress<Dim>(const FlowCurve&, double, double, const Mat<Dim>&, \
                                                const StressState<Dim>&);
SMELT_INSTANTIATE(1)
SMELT_INSTANTIATE(2)
SMELT_INSTANTIATE(3)
#undef SMELT_INSTANTIATE

}  // namespace smelt
#endif
