// Particles that come in and go out between steps (core/sph/open_boundary.h).
#include "core/error.h"
#include "core/parallel.h"
#include "core/sph/enthalpy.h"
#include "core/sph/kernel.h"
#include "core/sph/reorder.h"
#include "core/sph/rheology.h"
#include "core/sph/solver.h"

#include <algorithm>
#include <limits>

namespace smelt {

/// Refuses what open boundaries cannot go with, and starts the account of a simulation that has some.
template <int Dim, typename Real>
void Solver<Dim, Real>::open_boundaries() {
  const auto& emitters = parameters_.emitters;
  if (emitters.empty() && parameters_.outflows.empty()) return;
  if (terms_.gas) fail("simulation: emitters and outflows are for liquids, not for an ideal gas");
  if (emitters.size() > 255) fail("simulation: up to 255 emitters are possible, there are {}", emitters.size());
  if (!emitters.empty() && parameters_.density != DensityForm::continuity)
    fail(
        "simulation: emitters go with the continuity equation; a density that is a sum would see the back of a vent as "
        "a free surface");
  if (!emitters.empty() && terms_.periodic)
    fail("simulation: a periodic box has no emitters: what comes in could not go out of it");
  for (const Emitter<Dim>& emitter : emitters)
    layers_.push_back(compute_emitter_layers<Dim>(emitter, parameters_.particle_volume,
                                                  kernel_kappa(parameters_.kernel) * parameters_.smoothing_length));
  if (!emitters.empty()) particles_.driven.resize(particles_.size(), 0);
  if (!account_.initial.empty()) return;
  account_.initial.resize(materials_.size(), 0);
  account_.removed.resize(materials_.size(), 0);
  account_.entered.resize(emitters.size(), 0);
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    ++account_.initial[particles_.material.empty() ? 0 : particles_.material[i]];
    account_.next_id = std::max(account_.next_id, particles_.id[i] + 1);
  }
}

/// A driven particle has the pressure of the fluid before it, with what gravity adds on the way: relative to the
/// density at rest,
///   rho_i/rho0_i - 1 = sum_j V_j W_ij (rho_j/rho0_j - 1 + g.x_ij/c^2) / sum_j V_j W_ij  over the free j,
/// where that is positive, else 0. What leaves the duct meets its like. A vent does not suck at fluid that pulls away
/// from it: where it did, each would make the other thinner without end.
template <int Dim, typename Real>
double Solver<Dim, Real>::match_driven_density(std::size_t i) const {
  using Fields = PairFields<Dim, Real>;
  const Kernel<Dim> kernel(parameters_.smoothing_length, parameters_.kernel);
  const double per_c2 = 1.0 / (parameters_.sound_speed * parameters_.sound_speed);
  const auto record = [&](std::size_t j) { return fields_.record(j); };
  double sum = 0.0, weight = 0.0;
  for (const std::int32_t neighbour : lists_.row(i)) {
    const auto j = static_cast<std::size_t>(neighbour);
    if (is_driven(j)) continue;
    Vec<Dim> x_ij;
    for (int a = 0; a < Dim; ++a) x_ij[a] = static_cast<double>(record(i)[a]) - record(j)[a];
    const double w = record(j)[Fields::volume_at] * kernel.value(x_ij.norm());
    sum += w * (record(j)[Fields::density_at] / material(j).density - 1.0 + parameters_.gravity.dot(x_ij) * per_c2);
    weight += w;
  }
  return material(i).density * (1.0 + (sum > 0.0 ? sum / weight : 0.0));
}

/// From the records that the rates were summed with, before any of them changes.
template <int Dim, typename Real>
void Solver<Dim, Real>::match_driven_densities() {
  if (particles_.driven.empty()) return;
  parallel_for_each(particles_.size(), [&](std::size_t i) {
    if (is_driven(i)) particles_.density[i] = match_driven_density(i);
  });
}

/// Lets go what has left its duct, takes out what has flown out and pours in what is due. The only place where the
/// number of particles changes.
template <int Dim, typename Real>
void Solver<Dim, Real>::exchange_particles(double time) {
  if (parameters_.emitters.empty() && parameters_.outflows.empty()) return;
  release_driven();
  const bool fewer = remove_outflow();
  const bool more = pour_in(time);
  if (!fewer && !more) return;
  resize_derived();
  if (walls_) walls_->grow(particles_.size());
  travelled_ = std::numeric_limits<double>::infinity();  // the lists name particles that are not there
}

template <int Dim, typename Real>
void Solver<Dim, Real>::release_driven() {
  for (std::size_t i = 0; i < particles_.driven.size(); ++i) {
    if (particles_.driven[i] == 0) continue;
    const std::size_t e = particles_.driven[i] - 1U;
    const Emitter<Dim>& emitter = parameters_.emitters[e];
    if ((particles_.position[i] - emitter.position).dot(emitter.direction) >= layers_[e].depth)
      particles_.driven[i] = 0;
  }
}

/// Whether anything flew out.
template <int Dim, typename Real>
bool Solver<Dim, Real>::remove_outflow() {
  if (parameters_.outflows.empty()) return false;
  std::vector<std::int32_t> keep;
  keep.reserve(particles_.size());
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const bool out =
        !is_driven(i) && std::any_of(parameters_.outflows.begin(), parameters_.outflows.end(),
                                     [&](const Outflow<Dim>& o) { return o.removes(particles_.position[i]); });
    if (out)
      ++account_.removed[particles_.material.empty() ? 0 : particles_.material[i]];
    else
      keep.push_back(static_cast<std::int32_t>(i));
  }
  if (keep.size() == particles_.size()) return false;
  for_each_array(particles_, [&](auto& values) { keep_only(values, keep); });
  keep_only(specific_force_, keep);  // the first half of the next kick, and the drift after it
  keep_only(transport_, keep);
  keep_only(heat_balance_, keep);
  keep_only(rest_viscosity_, keep);
  keep_only(clearance_, keep);
  keep_only(free_surface_area_, keep);
  if (walls_) walls_->keep(keep);
  return true;
}

/// Whether anything came in.
template <int Dim, typename Real>
bool Solver<Dim, Real>::pour_in(double time) {
  const std::size_t before = particles_.size();
  for (std::size_t e = 0; e < layers_.size(); ++e) {
    const Emitter<Dim>& emitter = parameters_.emitters[e];
    const Material& m = materials_[emitter.material];
    const std::int64_t due = count_entered<Dim>(emitter, layers_[e], time);
    for (std::int64_t& k = account_.entered[e]; k < due; ++k) {
      if (account_.next_id == std::numeric_limits<std::int32_t>::max())
        fail("simulation: more than 2^31 particles were poured in");
      particles_.id.push_back(account_.next_id++);
      if (materials_.size() > 1) particles_.material.push_back(emitter.material);
      particles_.position.push_back(entered_position<Dim>(emitter, layers_[e], k, time));
      particles_.velocity.push_back(layers_[e].speed * emitter.direction);
      particles_.density.push_back(m.density);
      particles_.driven.push_back(static_cast<std::uint8_t>(e + 1));
      if (terms_.pair.has_heat()) particles_.temperature.push_back(emitter.temperature);
      if (terms_.latent_heat) particles_.enthalpy.push_back(enthalpy_at(*m.heat, emitter.temperature));
      if (!terms_.pair.stress) continue;
      const double u = !m.heat ? 0.0
                       : m.heat->latent_heat > 0.0
                           ? melted_fraction_at_enthalpy(*m.heat, enthalpy_at(*m.heat, emitter.temperature))
                           : melted_fraction(*m.heat, emitter.temperature);
      particles_.stress.push_back(Symmetric<Dim>::Zero());
      particles_.viscosity.push_back(
          static_cast<float>(viscosity(flow_curve_at(m.rheology, u, emitter.temperature), 0.0)));
    }
  }
  return particles_.size() != before;
}

template class Solver<3, float>;
template class Solver<3, double>;
template class Solver<2, double>;
template class Solver<1, double>;

}  // namespace smelt
