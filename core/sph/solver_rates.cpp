// The first half of a step's sums: pressure gradients, the first pass over pairs, and what follows from it for density,
// heat and stress.
#include "core/parallel.h"
#include "core/sph/gradient_correction.h"
#include "core/sph/solver.h"
#include "core/sph/stress_update.h"
#include "core/sph/wall_terms.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace smelt {

namespace {

template <int Dim, typename Real>
Mat<Dim> unpack(const std::array<Real, n_symmetric<Dim>>& packed) {
  Symmetric<Dim> values;
  for (int k = 0; k < n_symmetric<Dim>; ++k) values[k] = packed[static_cast<std::size_t>(k)];
  return to_matrix<Dim>(values);
}

template <int Dim, typename Real>
Mat<Dim> unpack_gradient(const std::array<Real, Dim * Dim>& row_major) {
  Mat<Dim> gradient;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) gradient(a, b) = row_major[static_cast<std::size_t>(a * Dim + b)];
  return gradient;
}

/// How much of what the bare divergence misses the corrected one adds, by the position moment: all of it where
/// neighbours are missing, nothing where the support is full (its trace over Dim is 1 in the bulk, some 0.65 at a flat
/// free surface). There the bare rate is the derivative of a sum over neighbours, so that a density follows them
/// wherever they go; the corrected one would let them crowd. What walls miss, mirrored, stays
/// (docs/decisions/0015-thin-flows.md, 0008-walls.md).
template <int Dim>
double missing_support(const Mat<Dim>& position_moment) {
  constexpr double surface = 0.9, bulk = 1.0;
  return std::clamp((bulk - position_moment.trace() / Dim) / (bulk - surface), 0.0, 1.0);
}

}  // namespace

/// Where density is a sum, it follows from the positions alone.
template <int Dim, typename Real>
void Solver<Dim, Real>::sum_densities() {
  if (parameters_.density == DensityForm::continuity) return;
  set_summed_densities(false);
  // [S 4.20] has V_j from the densities of the step before. Evenly compressed, those would come out again, and nothing
  // would resist: the volumes follow from the plain sums instead.
  if (parameters_.density == DensityForm::normalised_summation) set_summed_densities(true);
}

template <int Dim, typename Real>
void Solver<Dim, Real>::set_summed_densities(bool normalise) {
  using Fields = PairFields<Dim, Real>;
  const std::size_t n = particles_.size();
  density_sums_.resize(n);
  parallel_blocks(n, [&](std::size_t begin, std::size_t end) {
    compute_density_sums<Dim, Real>(fields_, lists_, parameters_.kernel, parameters_.smoothing_length, begin, end,
                                    density_sums_.data() + begin);
  });
  parallel_for_each(n, [&](std::size_t i) {
    const WallNeighbour<Dim>* wall = walls_ ? walls_->of(i) : nullptr;
    const double solid = wall ? wall->solid : 0.0;
    // Of the kernel in the fluid: the solid is taken to hold what the fluid does.
    const double rho = density_sums_[i].mass / (normalise ? static_cast<double>(density_sums_[i].volume) : 1.0 - solid);
    particles_.density[i] = rho;
    Real* record = fields_.record(i);
    record[Fields::volume_at] = static_cast<Real>(mass(i) / rho);
    record[Fields::density_at] = static_cast<Real>(rho);
  });
  copy_records_to_images();
}

/// The first pass over pairs, and what follows from its sums particle by particle, block after block, so that the sums
/// live no longer than a block does: density, heat and stress advance by dt to `time`. With dt = 0 nothing advances,
/// but the stress of a law without memory and the XSPH correction follow from the state.
template <int Dim, typename Real>
void Solver<Dim, Real>::advance_rates(double dt, double time) {
  end_stage(StepStage::records);
  if (walls_) wall_gradient_.resize(walls_->neighbours().size());
  if (terms_.diffusion) find_diffusion_gradients();
  end_stage(StepStage::gradients);
  match_driven_densities();
  if (terms_.exchange && dt > 0.0) find_source_powers(time);
  heat_ledger_ += deterministic_reduce_blocks(
      particles_.size(), HeatLedger{},
      [&](std::size_t begin, std::size_t end) { return advance_block(begin, end, dt, time); },
      [](HeatLedger a, const HeatLedger& b) { return a += b; });
  end_stage(StepStage::rates);
  parallel_for_each(particles_.size(), [&](std::size_t i) { terms_.gas ? pack_gas(i, dt) : pack_forces(i); });
  copy_records_to_images();
  end_stage(StepStage::records);
}

/// Particles [begin, end), block_size at most; returns the heat that passed through surface and walls.
template <int Dim, typename Real>
HeatLedger Solver<Dim, Real>::advance_block(std::size_t begin, std::size_t end, double dt, double time) {
  std::array<RateSums<Dim, Real>, block_size> rates;
  std::array<SightedSums<Dim, Real>, block_size> sighted;  // where sight differs
  compute_rate_sums<Dim, Real>(fields_, lists_, terms_.pair, parameters_.smoothing_length, begin, end, rates.data(),
                               sighted.data());
  if (terms_.diffusion) add_density_diffusion(begin, end, rates.data());
  if (walls_) add_walls(begin, end, rates.data(), sighted.data());
  StressBlock<Dim> stresses{};
  HeatLedger passed;
  for (std::size_t first = begin; first < end; first += stresses.capacity) {
    stresses.size = std::min(stresses.capacity, end - first);
    passed +=
        advance_together(first, rates.data() + (first - begin), sighted.data() + (first - begin), dt, time, stresses);
  }
  return passed;
}

/// As many particles from `first` on as `stresses` says, by what was summed for them.
template <int Dim, typename Real>
HeatLedger Solver<Dim, Real>::advance_together(std::size_t first, RateSums<Dim, Real>* rates,
                                               const SightedSums<Dim, Real>* sighted, double dt, double time,
                                               StressBlock<Dim>& stresses) {
  if (terms_.pair.stress || terms_.pair.has_heat()) {
    for (std::size_t m = 0; m < n_symmetric<Dim>; ++m)
      for (std::size_t k = 0; k < stresses.size; ++k) stresses.moment[m][k] = rates[k].position_moment[m];
    invert_moments<Dim>(stresses);
  }
  HeatLedger passed;
  for (std::size_t k = 0; k < stresses.size; ++k) {
    const std::size_t i = first + k;
    if (terms_.pair.has_heat()) {
      if (dt > 0.0) passed += advance_heat(i, rates[k].heat, dt, time);
      heat_balance_[i] = balance_heat<Dim, Real>(rates[k], stresses.correction_of(k));
    }
    if (terms_.pair.stress) collect_stress(i, k, rates[k], sighted[k], stresses);
    if (parameters_.density == DensityForm::continuity && !is_driven(i))
      particles_.density[i] += dt * rates[k].density_rate;
    if (terms_.pair.xsph)
      for (int a = 0; a < Dim; ++a) transport_[i][a] = static_cast<Real>(parameters_.xsph) * rates[k].xsph[a];
  }
  if (terms_.pair.stress) advance_stresses(first, dt, stresses);
  return passed;
}

/// Of the particles named, at walls [Pa/m]; where density diffuses in a fluid with a stress, everywhere.
template <int Dim, typename Real>
void Solver<Dim, Real>::evaluate_pressure_gradients(std::span<const std::int32_t> particles) {
  std::array<PressureGradientSums<Dim, Real>, block_size> sums;
  compute_pressure_gradient_sums<Dim, Real>(fields_, lists_, parameters_.kernel, parameters_.smoothing_length,
                                            particles, sums.data());
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const auto i = static_cast<std::size_t>(particles[k]);
    const WallNeighbour<Dim>* wall = walls_ ? walls_->of(i) : nullptr;
    const Vec<Dim> gradient =
        compute_pressure_gradient<Dim, Real>(sums[k], wall, particles_.density[i], parameters_.gravity);
    if (wall) wall_gradient_[walls_->slot(*wall)] = gradient;
    if (terms_.diffuses_along_gradients()) pack_gradient(i, gradient);
  }
}

/// For the diffusion of density.
template <int Dim, typename Real>
void Solver<Dim, Real>::pack_gradient(std::size_t i, const Vec<Dim>& gradient) {
  Real* packed = packed_gradient_.data() + i * gradient_stride<Dim>;
  for (int a = 0; a < Dim; ++a) packed[a] = static_cast<Real>(gradient[a]);
  packed[Dim] = fields_.record(i)[PairFields<Dim, Real>::pressure_at];
}

/// What density diffuses along. Where nothing but pressure (and artificial viscosity) acts, the fluid's motion says
/// what gradient there must be, rho (gravity - a), as in [Rhie & Chow 1983]: the corrected gradient follows an error of
/// the pressure where that is smooth, over two or three spacings at a wall, and would leave it alone for seconds. A
/// stress would take part in a.
template <int Dim, typename Real>
void Solver<Dim, Real>::find_diffusion_gradients() {
  constexpr std::size_t stride = gradient_stride<Dim>;
  const std::size_t n = particles_.size();
  packed_gradient_.resize((n + images_.size()) * stride);
  if (terms_.diffuses_along_gradients())
    parallel_blocks(n, [&](std::size_t begin, std::size_t end) {
      std::array<std::int32_t, block_size> particles;
      std::iota(particles.begin(), particles.begin() + (end - begin), static_cast<std::int32_t>(begin));
      evaluate_pressure_gradients({particles.data(), end - begin});
    });
  else
    parallel_for_each(
        n, [&](std::size_t i) { pack_gradient(i, particles_.density[i] * (parameters_.gravity - acceleration(i))); });
  for (std::size_t k = 0; k < images_.size(); ++k)
    std::copy_n(packed_gradient_.data() + stride * static_cast<std::size_t>(images_.source[k]), stride,
                packed_gradient_.data() + stride * (n + k));
}

/// drho_i/dt += delta h c sum ..., where p/c^2 stands for the density.
template <int Dim, typename Real>
void Solver<Dim, Real>::add_density_diffusion(std::size_t begin, std::size_t end, RateSums<Dim, Real>* rates) const {
  const double strength = parameters_.density_diffusion * parameters_.smoothing_length / parameters_.sound_speed;
  std::array<Real, block_size> sums;
  compute_pressure_diffusion_sums<Dim, Real>(fields_, packed_gradient_, lists_, parameters_.kernel,
                                             parameters_.smoothing_length, begin, end, sums.data());
  for (std::size_t k = 0; k < end - begin; ++k) rates[k].density_rate += static_cast<Real>(strength * sums[k]);
}

/// What walls add to the sums of particles [begin, end), and the pressure's gradients at them, while what both read is
/// in the caches.
template <int Dim, typename Real>
void Solver<Dim, Real>::add_walls(std::size_t begin, std::size_t end, RateSums<Dim, Real>* rates,
                                  SightedSums<Dim, Real>* sighted) {
  std::array<std::int32_t, block_size> walled;
  std::size_t n_walled = 0;
  for (std::size_t i = begin; i < end; ++i)
    if (walls_->of(i)) walled[n_walled++] = static_cast<std::int32_t>(i);
  const std::span<const std::int32_t> near(walled.data(), n_walled);
  if (!terms_.diffuses_along_gradients()) evaluate_pressure_gradients(near);
  for (const std::int32_t i : near) {
    const std::size_t k = static_cast<std::size_t>(i) - begin;
    add_wall_rates(*walls_->of(static_cast<std::size_t>(i)), rates[k], sighted[k]);
  }
}

template <int Dim, typename Real>
void Solver<Dim, Real>::add_wall_rates(const WallNeighbour<Dim>& wall, RateSums<Dim, Real>& rate,
                                       SightedSums<Dim, Real>& sighted) const {
  using Fields = PairFields<Dim, Real>;
  const auto i = static_cast<std::size_t>(wall.particle);
  Vec<Dim> velocity;  // the one that the pair sums were made with
  for (int a = 0; a < Dim; ++a) velocity[a] = fields_.record(i)[Fields::velocity_at + a];
  accumulate_wall_rates<Dim, Real>(wall, colliders_, terms_.pair, velocity, particles_.density[i], material(i).density,
                                   terms_.pair.has_heat() ? particles_.temperature[i] : 0.0,
                                   terms_.pair.has_heat() ? static_cast<double>(heat_balance_[i].moment_trace) : 1.0,
                                   rate, terms_.pair.sight ? &sighted : nullptr);
}

/// What the stress of particle `i`, the k-th of `stresses`, advances by.
template <int Dim, typename Real>
void Solver<Dim, Real>::collect_stress(std::size_t i, std::size_t k, RateSums<Dim, Real>& rate,
                                       const SightedSums<Dim, Real>& sighted, StressBlock<Dim>& stresses) {
  if (parameters_.corrected_divergence) {
    const Mat<Dim> bare = unpack_gradient<Dim, Real>(rate.velocity_moment);
    const double missed = (bare * stresses.correction_of(k)).trace() - bare.trace();
    rate.density_rate -= static_cast<Real>(particles_.density[i] *
                                           missing_support<Dim>(unpack<Dim, Real>(rate.position_moment)) * missed);
  }
  const bool sees_less = terms_.pair.sight && sighted.position_moment != rate.position_moment;
  const auto& moment = sees_less ? sighted.velocity_moment : rate.velocity_moment;
  for (std::size_t ab = 0; ab < Dim * Dim; ++ab) stresses.bare_gradient[ab][k] = moment[ab];
  if (sees_less)
    stresses.set_correction(k, compute_gradient_correction<Dim>(unpack<Dim, Real>(sighted.position_moment)));
  for (std::size_t m = 0; m < n_symmetric<Dim>; ++m) stresses.stress[m][k] = particles_.stress[i][m];
  stresses.viscosity[k] = particles_.viscosity[i];
  const FlowCurve curve = flow_curve_of(i);
  stresses.set_curve(k, curve);
  if (!rest_viscosity_.empty()) keep_rest_viscosity(i, curve);
  stresses.modulus[k] = material(i).density * parameters_.shear_wave_speed * parameters_.shear_wave_speed;
}

/// Advances the extra stress S of the collected particles, the first of which is `first`, and packs S L for the force
/// pass.
template <int Dim, typename Real>
void Solver<Dim, Real>::advance_stresses(std::size_t first, double dt, StressBlock<Dim>& stresses) {
  correct_gradients<Dim>(stresses);
  if (terms_.relaxed && dt > 0.0) relax_stresses<Dim>(dt, stresses);
  if (!terms_.relaxed) follow_strain_rates<Dim>(stresses);
  for (std::size_t k = 0; k < stresses.size; ++k) {
    Symmetric<Dim>& stress = particles_.stress[first + k];
    if (is_driven(first + k)) {  // keeps what it has
      for (std::size_t m = 0; m < n_symmetric<Dim>; ++m) stresses.stress[m][k] = stress[m];
      continue;
    }
    for (std::size_t m = 0; m < n_symmetric<Dim>; ++m) stress[m] = stresses.stress[m][k];
    particles_.viscosity[first + k] = static_cast<float>(stresses.viscosity[k]);
  }
  correct_stresses<Dim>(stresses);
  for (std::size_t k = 0; k < stresses.size; ++k) pack_stress(first + k, k, stresses);
}

template class Solver<3, float>;
template class Solver<3, double>;
template class Solver<2, double>;
template class Solver<1, double>;

}  // namespace smelt
