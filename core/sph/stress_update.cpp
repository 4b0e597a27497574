#include "core/sph/stress_update.h"

#include <cmath>

namespace smelt {

namespace {

template <int Dim>
double magnitude(const Mat<Dim>& symmetric) {
  return std::sqrt(0.5 * symmetric.squaredNorm());
}

/// Rotation over a step with constant velocity gradient: (1 - H)^-1 (1 + H) of the skew H = W dt/2, orthogonal to rounding. As
/// H^3 = -|H|^2 H with |H|^2 = H:H/2, it is 1 + 2 (H + H^2)/(1 + |H|^2).
template <int Dim>
Mat<Dim> step_rotation(const Mat<Dim>& velocity_gradient, double dt) {
  const Mat<Dim> half_spin = 0.25 * dt * (velocity_gradient - velocity_gradient.transpose());
  const double scale = 2.0 / (1.0 + 0.5 * half_spin.squaredNorm());
  return Mat<Dim>::Identity() + scale * (half_spin + half_spin * half_spin);
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
StressState<Dim> relaxed_stress(const FlowCurve& curve, double shear_modulus, double dt, const Mat<Dim>& velocity_gradient,
                                const StressState<Dim>& before) {
  Mat<Dim> strain_rate = velocity_gradient + velocity_gradient.transpose();
  strain_rate -= strain_rate.trace() / Dim * Mat<Dim>::Identity();
  const Mat<Dim> rotation = step_rotation<Dim>(velocity_gradient, dt);
  const Mat<Dim> old_stress = to_matrix<Dim>(before.stress);
  const Mat<Dim> trial = rotation * old_stress * rotation.transpose() + shear_modulus * dt * strain_rate;

  const double trial_magnitude = magnitude<Dim>(trial);
  if (trial_magnitude == 0.0) return {Symmetric<Dim>::Zero(), viscosity(curve, 0.0)};
  const double guess = before.viscosity > 0.0 ? magnitude<Dim>(old_stress) / before.viscosity : 0.0;
  const double rate = relaxed_shear_rate(curve, shear_modulus * dt, trial_magnitude, guess);
  const double relaxed_magnitude = trial_magnitude - shear_modulus * dt * rate;
  return {to_symmetric<Dim>(relaxed_magnitude / trial_magnitude * trial),
          rate > 0.0 ? relaxed_magnitude / rate : curve.rest_viscosity};
}

#define SMELT_INSTANTIATE(Dim)                                                                              \
  template double stress_magnitude<Dim>(const Symmetric<Dim>&);                                             \
  template StressState<Dim> instant_stress<Dim>(const FlowCurve&, const Mat<Dim>&);                         \
  template StressState<Dim> relaxed_stress<Dim>(const FlowCurve&, double, double, const Mat<Dim>&, const StressState<Dim>&);
SMELT_INSTANTIATE(1)
SMELT_INSTANTIATE(2)
SMELT_INSTANTIATE(3)
#undef SMELT_INSTANTIATE

}  // namespace smelt
