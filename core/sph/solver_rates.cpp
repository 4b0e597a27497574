// The first half of a step's sums: pressure gradients, the first pass over pairs, and what follows from it for density,
// heat and stress.
#include "core/parallel.h"
#include "core/sph/gradient_correction.h"
#include "core/sph/solver.h"
#include "core/sph/stress_update.h"
#include "core/sph/wall_terms.h"

#include <algorithm>
#include <array>

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
  if (walls_ || terms_.diffusion) evaluate_pressure_gradients();
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
  StressBlock<Dim> stresses{};
  HeatLedger passed;
  for (std::size_t i = begin; i < end; ++i) {
    RateSums<Dim, Real>& rate = rates[i - begin];
    if (const WallNeighbour<Dim>* wall = walls_ ? walls_->of(i) : nullptr)
      add_wall_rates(*wall, rate, sighted[i - begin]);
    Mat<Dim> correction = Mat<Dim>::Zero();
    if (terms_.pair.stress || terms_.pair.has_heat())
      correction = compute_gradient_correction<Dim>(unpack<Dim, Real>(rate.position_moment));
    if (terms_.pair.has_heat()) {
      if (dt > 0.0) passed += advance_heat(i, rate.heat, dt, time);
      heat_balance_[i] = balance_heat<Dim, Real>(rate, correction);
    }
    if (terms_.pair.stress) collect_stress(i, correction, rate, sighted[i - begin], stresses);
    if (parameters_.density == DensityForm::continuity && !is_driven(i))
      particles_.density[i] += dt * rate.density_rate;
    if (stresses.size == StressBlock<Dim>::capacity || (stresses.size > 0 && i + 1 == end))
      advance_stresses(i + 1 - stresses.size, dt, stresses);
    if (terms_.pair.xsph)
      for (int a = 0; a < Dim; ++a) transport_[i][a] = static_cast<Real>(parameters_.xsph) * rate.xsph[a];
  }
  return passed;
}

/// Near walls; everywhere where density diffuses in a fluid with a stress. Where nothing but pressure (and artificial
/// viscosity) acts, the fluid's motion says what gradient there must be for the diffusion, rho (gravity - a), as in
/// [Rhie & Chow 1983]: the corrected gradient follows an error of the pressure where that is smooth, over two or three
/// spacings at a wall, and would leave it alone for seconds. A stress would take part in a.
template <int Dim, typename Real>
void Solver<Dim, Real>::evaluate_pressure_gradients() {
  constexpr std::size_t stride = gradient_stride<Dim>;
  const std::size_t n = particles_.size();
  const auto pack = [&](std::size_t i, const Vec<Dim>& gradient) {
    Real* packed = packed_gradient_.data() + i * stride;
    for (int a = 0; a < Dim; ++a) packed[a] = static_cast<Real>(gradient[a]);
    packed[Dim] = fields_.record(i)[PairFields<Dim, Real>::pressure_at];
  };
  const bool everywhere = terms_.diffusion && terms_.pair.stress;
  if (walls_) wall_gradient_.resize(walls_->neighbours().size());
  if (terms_.diffusion) packed_gradient_.resize((n + images_.size()) * stride);
  const auto evaluate = [&](std::span<const std::int32_t> particles) {
    std::array<PressureGradientSums<Dim, Real>, block_size> sums;
    compute_pressure_gradient_sums<Dim, Real>(fields_, lists_, parameters_.kernel, parameters_.smoothing_length,
                                              particles, sums.data());
    for (std::size_t k = 0; k < particles.size(); ++k) {
      const auto i = static_cast<std::size_t>(particles[k]);
      const WallNeighbour<Dim>* wall = walls_ ? walls_->of(i) : nullptr;
      const Vec<Dim> gradient =
          compute_pressure_gradient<Dim, Real>(sums[k], wall, particles_.density[i], parameters_.gravity);
      if (wall) wall_gradient_[walls_->slot(*wall)] = gradient;
      if (everywhere) pack(i, gradient);
    }
  };
  if (everywhere || walls_)
    parallel_blocks(everywhere ? n : walls_->neighbours().size(), [&](std::size_t begin, std::size_t end) {
      std::array<std::int32_t, block_size> particles;
      for (std::size_t k = begin; k < end; ++k)
        particles[k - begin] = everywhere ? static_cast<std::int32_t>(k) : walls_->neighbours()[k].particle;
      evaluate({particles.data(), end - begin});
    });
  if (!terms_.diffusion) return;
  if (!everywhere)
    parallel_for_each(n,
                      [&](std::size_t i) { pack(i, particles_.density[i] * (parameters_.gravity - acceleration(i))); });
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

/// Adds particle `i` to those whose stress advances together; `correction` is L where sight does not differ.
template <int Dim, typename Real>
void Solver<Dim, Real>::collect_stress(std::size_t i, const Mat<Dim>& correction, RateSums<Dim, Real>& rate,
                                       const SightedSums<Dim, Real>& sighted, StressBlock<Dim>& stresses) {
  if (parameters_.corrected_divergence) {
    const Mat<Dim> bare = unpack_gradient<Dim, Real>(rate.velocity_moment);
    const double missed = (bare * correction).trace() - bare.trace();
    rate.density_rate -= static_cast<Real>(particles_.density[i] *
                                           missing_support<Dim>(unpack<Dim, Real>(rate.position_moment)) * missed);
  }
  const std::size_t k = stresses.size++;
  const bool sees_less = terms_.pair.sight && sighted.position_moment != rate.position_moment;
  const auto& moment = sees_less ? sighted.velocity_moment : rate.velocity_moment;
  const Mat<Dim> of_seen =
      sees_less ? compute_gradient_correction<Dim>(unpack<Dim, Real>(sighted.position_moment)) : correction;
  for (std::size_t a = 0; a < Dim; ++a)
    for (std::size_t b = 0; b < Dim; ++b) {
      stresses.bare_gradient[a * Dim + b][k] = moment[a * Dim + b];
      stresses.correction[a * Dim + b][k] = of_seen(a, b);
    }
  for (std::size_t m = 0; m < n_symmetric<Dim>; ++m) stresses.stress[m][k] = particles_.stress[i][m];
  stresses.viscosity[k] = particles_.viscosity[i];
  const FlowCurve curve = flow_curve_of(i);
  stresses.set_curve(k, curve);
  if (!rest_viscosity_.empty()) keep_rest_viscosity(i, curve);
  stresses.modulus[k] = material(i).density * parameters_.shear_wave_speed * parameters_.shear_wave_speed;
}

/// Advances the extra stress S of the collected particles, the first of which is `first`, and packs S L for the force
/// pass. Empties the collection.
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
  stresses.size = 0;
}

template class Solver<3, float>;
template class Solver<3, double>;
template class Solver<2, double>;
template class Solver<1, double>;

}  // namespace smelt
