#pragma once
// The extra stress over one step: of one particle, and of many at once.

#include "core/sph/particles.h"
#include "core/sph/rheology.h"

#include <array>
#include <cstddef>

namespace smelt {

/// Extra stress and the viscosity it stands for.
template <int Dim>
struct StressState {
  Symmetric<Dim> stress;   ///< S [Pa]
  double viscosity = 0.0;  ///< eta [Pa s]
};

/// |S| = sqrt(tr(S^2)/2), so that |S| = eta gdot where S = eta D.
template <int Dim>
double stress_magnitude(const Symmetric<Dim>& stress);

/// S = eta(gdot) D with D = grad v + (grad v)^T, gdot = sqrt(tr(D^2)/2)  [P 4-45, 4-46, 6-1]. Explicit integration of
/// it is stable only for dt < 0.1 h^2 rho / (8 eta) [P 6-17]: use it where eta is small everywhere.
template <int Dim>
StressState<Dim> instant_stress(const FlowCurve& curve, const Mat<Dim>& velocity_gradient);

/// Backward-Euler relaxation of a Maxwell element whose dashpot follows the flow curve: the shear rate y >= 0 of the
/// dashpot with
///   tau(y) + modulus_dt y = trial_stress,
/// where modulus_dt = G dt [Pa s]. Unique, as tau grows with y. `guess` [1/s] is where the search starts; it changes
/// the result by rounding only. Solved to 1e-10 of trial_stress.
double relaxed_shear_rate(const FlowCurve& curve, double modulus_dt, double trial_stress, double guess);

/// Particles whose stress is advanced together, a vector of them at a time: an array for each entry of each field. Make
/// it with {}: what fills the last vector beyond `size` is computed, though not used.
template <int Dim>
struct StressBlock {
  static constexpr std::size_t capacity = 32;
  using Field = std::array<double, capacity>;

  std::size_t size = 0;                                    ///< particles in it
  alignas(64) std::array<Field, n_symmetric<Dim>> moment;  ///< M, packed (core/sph/gradient_correction.h)
  std::array<Field, Dim * Dim> bare_gradient;              ///< sum V_j (v_j - v_i) (x) grad_w_ij, row-major [1/s]
  std::array<Field, Dim * Dim> correction;                 ///< L, row-major
  std::array<Field, Dim * Dim> gradient;                   ///< of the velocity, bare_gradient L [1/s]
  std::array<Field, n_symmetric<Dim>> stress;              ///< S [Pa]
  std::array<Field, Dim * Dim> corrected_stress;           ///< S L [Pa]
  Field viscosity;                                         ///< eta = |S| / gdot [Pa s]
  Field yield_stress, consistency, index, rest_viscosity;  ///< of the flow curves
  Field modulus;                                           ///< G [Pa]

  void set_curve(std::size_t k, const FlowCurve& curve) {
    yield_stress[k] = curve.yield_stress;
    consistency[k] = curve.consistency;
    index[k] = curve.index;
    rest_viscosity[k] = curve.rest_viscosity;
  }
  Mat<Dim> correction_of(std::size_t k) const {
    Mat<Dim> l;
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) l(a, b) = correction[a * Dim + b][k];
    return l;
  }
  void set_correction(std::size_t k, const Mat<Dim>& l) {
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) correction[a * Dim + b][k] = l(a, b);
  }
  FlowCurve curve(std::size_t k) const { return {yield_stress[k], consistency[k], index[k], rest_viscosity[k]}; }
};

/// `correction` from `moment`: compute_gradient_correction of each.
template <int Dim>
void invert_moments(StressBlock<Dim>& block);

/// `gradient` from `bare_gradient` and `correction`.
template <int Dim>
void correct_gradients(StressBlock<Dim>& block);

/// Stress and viscosity after `dt` [s] with the law above, but with a relaxed stress
/// (docs/decisions/0003-relaxed-stress.md): a Maxwell element in which a spring of shear modulus G is in series with
/// the dashpot of the flow curve,
///   DS/Dt = G (D - S/eta),  eta = tau(y)/y at the dashpot's own rate y,  D the deviatoric strain rate,
/// DS/Dt following the material's rotation (Hughes & Winget 1980). Backward Euler in the dashpot, so any viscosity is
/// stable at the step that the shear wave sqrt(G/rho) allows; in steady flow |S| = tau(gdot), the SMD law itself. A
/// particle's bytes depend neither on its company nor on the machine's instructions.
template <int Dim>
void relax_stresses(double dt, StressBlock<Dim>& block);

/// Stress and viscosity of instant_stress.
template <int Dim>
void follow_strain_rates(StressBlock<Dim>& block);

/// `corrected_stress` from `stress` and `correction`.
template <int Dim>
void correct_stresses(StressBlock<Dim>& block);

/// relax_stresses for one particle.
template <int Dim>
StressState<Dim> relaxed_stress(const FlowCurve& curve, double shear_modulus, double dt,
                                const Mat<Dim>& velocity_gradient, const StressState<Dim>& before);

}  // namespace smelt
