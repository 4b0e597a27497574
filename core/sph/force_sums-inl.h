// The second pass over pairs, accelerations, for one instruction set.
#if defined(SMELT_FORCE_SUMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SMELT_FORCE_SUMS_INL_H
#undef SMELT_FORCE_SUMS_INL_H
#else
#define SMELT_FORCE_SUMS_INL_H
#endif

#include "core/sph/pair_records-inl.h"
#include "core/sph/pair_sums.h"
#include "core/sph/particles.h"

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <type_traits>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace smelt {
namespace HWY_NAMESPACE {

/// Hourglass control: what of the approach v_ij.x_ij = `v_x`, times the pair's viscosity, no velocity gradient of
/// either particle sees. Where sight counts, the two sides are weighed by `scale_i` and `scale_j`.
template <int Dim, typename Real, bool with_sight>
HWY_INLINE Simd<Real> unseen_motion(const Neighbours<Dim, Real>& pair, const Real* stress_i, const Simd<Real>* stress_j,
                                    [[maybe_unused]] Simd<Real> scale_i, [[maybe_unused]] Simd<Real> scale_j,
                                    Simd<Real> v_x) {
  using Fields = PairFields<Dim, Real>;
  const auto of_i = [&](int field) HWY_ATTR { return hn::Set(Tag<Real>(), stress_i[field]); };
  const auto of_j = [&](int field) HWY_ATTR { return stress_j[field]; };
  auto unseen_i = hn::Mul(of_i(Fields::hourglass_at), v_x), unseen_j = hn::Mul(of_j(Fields::hourglass_at), v_x);
  for (int m = 0; m < n_symmetric<Dim>; ++m) {
    const auto [a, b] = symmetric_entry<Dim>(m);
    const auto x_x = hn::Mul(pair.x_ij[a], pair.x_ij[b]);
    unseen_i = hn::NegMulAdd(of_i(Fields::hourglass_at + 1 + m), x_x, unseen_i);
    unseen_j = hn::NegMulAdd(of_j(Fields::hourglass_at + 1 + m), x_x, unseen_j);
  }
  if constexpr (with_sight) return hn::MulAdd(scale_i, unseen_i, hn::Mul(scale_j, unseen_j));
  return hn::Add(unseen_i, unseen_j);
}

template <typename PairKernel, int Dim, typename Real, bool with_stress, bool with_sight, bool with_hourglass>
void force_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, const ForceParameters& parameters,
                std::size_t begin, std::size_t end, std::array<Real, Dim>* acceleration) {
  const Tag<Real> d;
  const double h = parameters.smoothing_length;
  const PairKernel kernel(h);
  using Fields = PairFields<Dim, Real>;
  const Real* records = fields.records.data();
  constexpr int way_at = Dim, n_sums = with_stress ? 2 * Dim : Dim;  // the force is first
  [[maybe_unused]] const std::ptrdiff_t stresses_at = fields.stresses_at;
  const auto soft = hn::Set(d, static_cast<Real>(0.01 * h * h));
  // Pi_ij = -alpha c mu_ij / (0.5 (rho_i + rho_j)), mu_ij = h v_ij.x_ij / (r^2 + 0.01 h^2) where they approach.
  const auto damping =
      hn::Set(d, static_cast<Real>(2.0 * parameters.artificial_viscosity * parameters.sound_speed * h));
  [[maybe_unused]] const auto hourglass = hn::Set(d, static_cast<Real>(2 * (Dim + 2)));
  const auto one = hn::Set(d, Real(1));
  std::vector<std::int32_t> buffer(lists.room());
  for (std::size_t i = begin; i < end; ++i) {
    fetch_ahead<with_stress>(fields, lists, i);
    const Real* record_i = fields.record(i);
    [[maybe_unused]] const Real* stress_i = with_stress ? fields.stress(i) : nullptr;
    const auto density_i = hn::Set(d, record_i[Fields::density_at]);
    const auto inverse_density_i = hn::Set(d, 1 / record_i[Fields::density_at]);
    // One load of four for the pressure and what sight takes.
    constexpr int eta_at = Fields::rest_viscosity_of_forces_at, pressure_at = eta_at,
                  n_pressure = Fields::specific_pressure_at + 1 - pressure_at;
    [[maybe_unused]] const auto sight_of_i = hn::Set(d, static_cast<Real>(sight_of_thinner) * record_i[eta_at]);
    [[maybe_unused]] const auto sight_i = hn::Set(d, static_cast<Real>(sight_of_thinner) * record_i[eta_at + 1]);
    const auto add_pairs = [&](const std::int32_t* begins, Simd<Real>* sum) HWY_ATTR __attribute__((always_inline)) {
      const Neighbours<Dim, Real> pair(record_i, records, begins);
      const auto &x_ij = pair.x_ij, &v_ij = pair.v_ij;
      Simd<Real> pressure_j[padded_fields(n_pressure)];
      load_fields<Fields::record_size, n_pressure>(records, pressure_at, begins, pressure_j);
      const auto specific_pressure_j = pressure_j[Fields::specific_pressure_at - pressure_at];
      const auto r2 = dot<Dim, Real>(x_ij, x_ij);
      const auto volume_f = hn::Mul(pair.volume, kernel.gradient_over_r(r2));
      const auto v_x = dot<Dim, Real>(v_ij, x_ij);
      const auto approach = hn::Min(v_x, hn::Zero(d));
      // One division for both: they and the square root are what is slow here.
      const auto density_sum = hn::Add(density_i, pair.density);
      const auto inverse = hn::Div(one, hn::Mul(hn::Add(r2, soft), density_sum));
      const auto pi = hn::Mul(hn::Mul(damping, approach), inverse);
      const auto pressure = hn::Add(hn::Set(d, record_i[Fields::specific_pressure_at]), specific_pressure_j);
      // Along x_ij: -m_j (pressure + Pi_ij) F, with Pi_ij = -pi and m_j = V_j rho_j.
      auto along = hn::Mul(hn::Mul(pair.density, volume_f), hn::Sub(pi, pressure));
      if constexpr (with_stress) {
        constexpr int n_stress = Fields::n_stress(with_hourglass);
        Simd<Real> stress_j[padded_fields(n_stress)];
        load_fields<Fields::record_size, n_stress>(records, stresses_at, begins, stress_j);
        // m_j/(rho_i rho_j) = V_j/rho_i; times the sight of i, and of j.
        const auto scale = hn::Mul(volume_f, inverse_density_i);
        auto scale_i = scale, scale_j = scale;
        if constexpr (with_sight) {
          scale_i = hn::Mul(scale, hn::Min(one, hn::Mul(sight_i, pressure_j[0])));
          scale_j = hn::Mul(scale, hn::Min(one, hn::Mul(sight_of_i, pressure_j[1])));
        }
        for (int a = 0; a < Dim; ++a) {
          auto traction = hn::Mul(stress_j[a * Dim], x_ij[0]);
          for (int b = 1; b < Dim; ++b) traction = hn::MulAdd(stress_j[a * Dim + b], x_ij[b], traction);
          sum[a] = hn::MulAdd(scale_j, traction, sum[a]);
          // The particle's own stress is the same in all of its pairs.
          sum[way_at + a] = hn::MulAdd(scale_i, x_ij[a], sum[way_at + a]);
        }
        if constexpr (with_hourglass) {
          const auto unseen = unseen_motion<Dim, Real, with_sight>(pair, stress_i, stress_j, scale_i, scale_j, v_x);
          const auto strength = with_sight ? hourglass : hn::Mul(scale, hourglass);
          along = hn::MulAdd(hn::Mul(strength, hn::Mul(inverse, density_sum)), unseen, along);
        }
      }
      for (int a = 0; a < Dim; ++a) sum[a] = hn::MulAdd(along, x_ij[a], sum[a]);
    };
    Real total[n_sums];
    sum_row<n_sums>(fields.read_row(lists, i, buffer.data()), total, add_pairs);
    for (int a = 0; a < Dim; ++a) {
      acceleration[i - begin][a] = total[a];
      if constexpr (with_stress)
        for (int b = 0; b < Dim; ++b) acceleration[i - begin][a] += stress_i[a * Dim + b] * total[way_at + b];
    }
  }
}

template <typename PairKernel, int Dim, typename Real>
void gas_force_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,
                    const GasForceParameters& parameters, std::size_t begin, std::size_t end,
                    std::array<Real, Dim>* acceleration, Real* energy_rate) {
  const Tag<Real> d;
  const double h = parameters.smoothing_length;
  const PairKernel kernel(h);
  using Fields = PairFields<Dim, Real>;
  const Real* records = fields.records.data();
  const auto soft = hn::Set(d, static_cast<Real>(0.01 * h * h));
  const auto alpha = hn::Set(d, static_cast<Real>(parameters.artificial_viscosity));
  const auto two_beta = hn::Set(d, static_cast<Real>(2.0 * parameters.quadratic_artificial_viscosity));
  std::vector<std::int32_t> buffer(lists.room());
  for (std::size_t i = begin; i < end; ++i) {
    fetch_ahead<false>(fields, lists, i);
    const Real* record_i = fields.record(i);
    const auto add_pairs = [&](const std::int32_t* begins, Simd<Real>* sum) HWY_ATTR __attribute__((always_inline)) {
      const Neighbours<Dim, Real> pair(record_i, records, begins);
      const auto specific_pressure_j = load_field<Dim, Real, Fields::specific_pressure_at>(fields, begins);
      const auto sound_speed_j = load_field<Dim, Real, Fields::sound_speed_at>(fields, begins);
      const auto r2 = dot<Dim, Real>(pair.x_ij, pair.x_ij);
      const auto v_x = dot<Dim, Real>(pair.v_ij, pair.x_ij);
      // Twice c_ij and twice rho_ij: the halves cancel but for beta's.
      const auto mu = hn::Div(hn::Mul(hn::Set(d, static_cast<Real>(h)), hn::Min(v_x, hn::Zero(d))), hn::Add(r2, soft));
      const auto sound = hn::Add(hn::Set(d, record_i[Fields::sound_speed_at]), sound_speed_j);
      const auto density = hn::Add(hn::Set(d, record_i[Fields::density_at]), pair.density);
      const auto pi = hn::Div(hn::Mul(mu, hn::MulSub(two_beta, mu, hn::Mul(alpha, sound))), density);
      const auto pressure =
          hn::Add(hn::Add(hn::Set(d, record_i[Fields::specific_pressure_at]), specific_pressure_j), pi);
      const auto mass_f = hn::Mul(hn::Mul(pair.density, pair.volume), kernel.gradient_over_r(r2));
      const auto weight = hn::Mul(mass_f, pressure);
      for (int a = 0; a < Dim; ++a) sum[a] = hn::NegMulAdd(weight, pair.x_ij[a], sum[a]);
      sum[Dim] = hn::MulAdd(weight, v_x, sum[Dim]);
    };
    Real total[Dim + 1];  // the force and the energy
    sum_row<Dim + 1>(fields.read_row(lists, i, buffer.data()), total, add_pairs);
    std::copy_n(total, Dim, acceleration[i - begin].begin());
    energy_rate[i - begin] = Real(0.5) * total[Dim];
  }
}

/// Picks the loop compiled for just the terms in use.
template <typename PairKernel, int Dim, typename Real>
void select_force_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, const PairTerms& terms,
                       const ForceParameters& parameters, std::size_t begin, std::size_t end,
                       std::array<Real, Dim>* acceleration) {
  const auto run = [&](auto stress, auto sight, auto hourglass) HWY_ATTR {
    force_sums<PairKernel, Dim, Real, stress.value, sight.value, hourglass.value>(fields, lists, parameters, begin, end,
                                                                                  acceleration);
  };
  const auto with_sight = [&](auto hourglass) HWY_ATTR {
    terms.sight ? run(std::true_type{}, std::true_type{}, hourglass)
                : run(std::true_type{}, std::false_type{}, hourglass);
  };
  if (terms.hourglass)
    with_sight(std::true_type{});
  else if (terms.stress)
    with_sight(std::false_type{});
  else
    run(std::false_type{}, std::false_type{}, std::false_type{});
}

}  // namespace HWY_NAMESPACE
}  // namespace smelt
HWY_AFTER_NAMESPACE();

#endif  // SMELT_FORCE_SUMS_INL_H
