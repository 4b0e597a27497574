#pragma once
// The extra stress of one particle over one step.

#include "core/sph/particles.h"
#include "core/sph/rheology.h"

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

/// S = eta(gdot) D with D = grad v + (grad v)^T, gdot = sqrt(tr(D^2)/2)  [P 4-45, 4-46, 6-1]. Explicit integration of it is stable only
/// for dt < 0.1 h^2 rho / (8 eta) [P 6-17]: use it where eta is small everywhere.
template <int Dim>
StressState<Dim> instant_stress(const FlowCurve& curve, const Mat<Dim>& velocity_gradient);

/// The same law with a relaxed stress (docs/decisions/0003-relaxed-stress.md): a Maxwell element in which a spring of shear modulus
/// G [Pa] is in series with the dashpot of the flow curve,
///   DS/Dt = G (D - S/eta),  eta = tau(y)/y at the dashpot's own rate y,  D the deviatoric strain rate,
/// DS/Dt following the material's rotation (Hughes & Winget 1980). Backward Euler in the dashpot, so any viscosity is stable at the
/// step that the shear wave sqrt(G/rho) allows; in steady flow |S| = tau(gdot), the SMD law itself.
template <int Dim>
StressState<Dim> relaxed_stress(const FlowCurve& curve, double shear_modulus, double dt, const Mat<Dim>& velocity_gradient,
                                const StressState<Dim>& before);

}  // namespace smelt
