// The records that the pair loops read, made from the particles' state.
#include "core/parallel.h"
#include "core/sph/rheology.h"
#include "core/sph/solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace smelt {

template <int Dim, typename Real>
void Solver<Dim, Real>::pack_heat(std::size_t i, double largest_conductivity, Real* record) const {
  using Fields = PairFields<Dim, Real>;
  const Material& m = material(i);
  // Relative to the melting range, where single precision is needed most.
  record[Fields::heat_at] =
      static_cast<Real>(particles_.temperature[i] - (materials_.front().heat ? materials_.front().heat->cold : 0.0));
  record[Fields::conductivity_at] =
      static_cast<Real>(largest_conductivity > 0.0 && m.heat ? conductivity(m) / largest_conductivity : 0.0);
  record[Fields::inverse_trace_at] = 1 / heat_balance_[i].moment_trace;
  for (int a = 0; a < Dim; ++a) record[Fields::balance_at + a] = heat_balance_[i].lambda[a];
}

/// Its flow curve now.
template <int Dim, typename Real>
FlowCurve Solver<Dim, Real>::flow_curve_of(std::size_t i) const {
  const Material& m = material(i);
  return m.heat ? flow_curve_at(m.rheology, melted_fraction_of(i), particles_.temperature[i])
                : flow_curve_at(m.rheology, 0.0);
}

/// A power law without yield stress has none: that at 1/s.
template <int Dim, typename Real>
void Solver<Dim, Real>::keep_rest_viscosity(std::size_t i, const FlowCurve& curve) {
  constexpr double inviscid = 1e-30;
  const double eta = std::isfinite(curve.rest_viscosity) ? curve.rest_viscosity : curve.consistency;
  rest_viscosity_[i] = static_cast<Real>(std::max(inviscid, eta));
}

/// Whether viscosities at rest differ by more than a stress sees across.
template <int Dim, typename Real>
bool Solver<Dim, Real>::sight_differs() const {
  struct Range {
    double least, most;
  };
  const Range of_all = deterministic_reduce(
      rest_viscosity_.size(), Range{std::numeric_limits<double>::infinity(), 0.0},
      [&](std::size_t i) {
        return Range{rest_viscosity_[i], rest_viscosity_[i]};
      },
      [](const Range& a, const Range& b) {
        return Range{std::min(a.least, b.least), std::max(a.most, b.most)};
      });
  return of_all.most > sight_of_thinner * of_all.least;
}

template <int Dim, typename Real>
void Solver<Dim, Real>::pack_motion(bool with_transport) {
  using Fields = PairFields<Dim, Real>;
  const std::size_t n = particles_.size();
  fields_.resize(n + images_.size(), terms_.pair.stress);
  const bool with_pressure = walls_ || terms_.diffusion;
  double largest_conductivity = 0.0;
  for (const Material& m : materials_)
    if (m.heat) largest_conductivity = std::max(largest_conductivity, conductivity(m));
  parallel_for_each(n, [&](std::size_t i) {
    Real* record = fields_.record(i);
    const Vec<Dim> x = particles_.position[i] - origin_;
    for (int a = 0; a < Dim; ++a) record[a] = static_cast<Real>(x[a]);
    const RealVec velocity = with_transport ? transport_[i] : RealVec(particles_.velocity[i].template cast<Real>());
    for (int a = 0; a < Dim; ++a) record[Fields::velocity_at + a] = velocity[a];
    record[Fields::volume_at] = static_cast<Real>(mass(i) / particles_.density[i]);
    record[Fields::density_at] = static_cast<Real>(particles_.density[i]);
    if (terms_.pair.has_heat()) pack_heat(i, largest_conductivity, record);
    if (!rest_viscosity_.empty()) record[Fields::rest_viscosity_at] = rest_viscosity_[i];
    if (with_pressure) record[Fields::pressure_at] = static_cast<Real>(pressure(i));
  });
  terms_.pair.sight = sight_differs();
  copy_records_to_images();
}

template <int Dim, typename Real>
void Solver<Dim, Real>::copy_records_to_images() {
  using Fields = PairFields<Dim, Real>;
  const std::size_t n = particles_.size();
  parallel_for_each(images_.size(), [&](std::size_t k) {
    const std::size_t source = images_.source[k];
    Real* record = fields_.record(n + k);
    std::copy_n(fields_.record(source), Fields::record_size, record);
    if (terms_.pair.stress) std::copy_n(fields_.stress(source), Fields::record_size, fields_.stress(n + k));
    // From the state, as its source's: shifting the rounded record would round it twice.
    const Vec<Dim> x = particles_.position[source] + images_.shift[k] - origin_;
    for (int a = 0; a < Dim; ++a) record[a] = static_cast<Real>(x[a]);
  });
}

/// Of a liquid [Pa].
template <int Dim, typename Real>
double Solver<Dim, Real>::pressure(std::size_t i) const {
  return compute_pressure(parameters_.equation_of_state, parameters_.sound_speed, material(i).density,
                          particles_.density[i], 0.0);
}

/// The records of the force pass, from the state after the rates.
template <int Dim, typename Real>
void Solver<Dim, Real>::pack_forces(std::size_t i) {
  using Fields = PairFields<Dim, Real>;
  Real* record = fields_.record(i);
  const double rho = particles_.density[i];
  for (int a = 0; a < Dim; ++a) record[Fields::velocity_at + a] = static_cast<Real>(particles_.velocity[i][a]);
  record[Fields::volume_at] = static_cast<Real>(mass(i) / rho);
  record[Fields::density_at] = static_cast<Real>(rho);
  if (terms_.pair.sight) {
    const Real eta = record[Fields::rest_viscosity_at];  // until the pressure takes its place
    record[Fields::rest_viscosity_of_forces_at] = eta;
    record[Fields::rest_viscosity_of_forces_at + 1] = 1 / eta;
  }
  record[Fields::specific_pressure_at] = static_cast<Real>(pressure(i) / (rho * rho));
}

/// S L of particle `i`, the k-th of `stresses`. At once, while other particles' rates are still summed: the first pass
/// does not read it.
template <int Dim, typename Real>
void Solver<Dim, Real>::pack_stress(std::size_t i, std::size_t k, const StressBlock<Dim>& stresses) {
  Real* record = fields_.stress(i);
  for (std::size_t ab = 0; ab < Dim * Dim; ++ab) record[ab] = static_cast<Real>(stresses.corrected_stress[ab][k]);
  if (terms_.pair.hourglass) pack_hourglass(i, k, stresses);
}

/// The same for an ideal gas after a step of dt. Its forces depend on energy and velocity, so both are wanted at the
/// step's end: half a kick ahead, by the rates of the step before. What particles lose as kinetic energy they then gain
/// as heat to second order in dt.
template <int Dim, typename Real>
void Solver<Dim, Real>::pack_gas(std::size_t i, double dt) {
  using Fields = PairFields<Dim, Real>;
  const double ahead = 0.5 * dt;
  const Vec<Dim> velocity = particles_.velocity[i] + ahead * acceleration(i);
  const double e = particles_.internal_energy[i] + ahead * energy_rate_[i];
  const double rho = particles_.density[i];
  Real* record = fields_.record(i);
  for (int a = 0; a < Dim; ++a) record[Fields::velocity_at + a] = static_cast<Real>(velocity[a]);
  record[Fields::volume_at] = static_cast<Real>(mass(i) / rho);
  record[Fields::density_at] = static_cast<Real>(rho);
  const EquationOfState& state = parameters_.equation_of_state;
  record[Fields::specific_pressure_at] = static_cast<Real>(compute_pressure(state, 0.0, 1.0, rho, e) / (rho * rho));
  record[Fields::sound_speed_at] = static_cast<Real>(compute_sound_speed(state, 0.0, 1.0, rho, e));
}

/// A solid's viscosity would need tiny steps: with a relaxed stress, that of a shear wave over a quarter of a smoothing
/// length is enough.
template <int Dim, typename Real>
void Solver<Dim, Real>::pack_hourglass(std::size_t i, std::size_t k, const StressBlock<Dim>& stresses) {
  double eta = particles_.viscosity[i];
  if (terms_.relaxed)
    eta = std::min(eta, 0.25 * particles_.density[i] * parameters_.shear_wave_speed * parameters_.smoothing_length);
  const double half = 0.5 * parameters_.hourglass_control * eta;
  Real* record = fields_.stress(i) + PairFields<Dim, Real>::hourglass_at;
  record[0] = static_cast<Real>(half);
  for (int m = 0; m < n_symmetric<Dim>; ++m) {
    const auto [a, b] = symmetric_entry<Dim>(m);
    const double strain_rate = stresses.gradient[a * Dim + b][k] + stresses.gradient[b * Dim + a][k];
    record[1 + m] = static_cast<Real>((a == b ? 0.5 : 1.0) * half * strain_rate);
  }
}

template class Solver<3, float>;
template class Solver<3, double>;
template class Solver<2, double>;
template class Solver<1, double>;

}  // namespace smelt
