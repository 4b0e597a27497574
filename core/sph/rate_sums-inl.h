// The first pass over pairs, rates and moments, for one instruction set.
#if defined(SMELT_RATE_SUMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SMELT_RATE_SUMS_INL_H
#undef SMELT_RATE_SUMS_INL_H
#else
#define SMELT_RATE_SUMS_INL_H
#endif

#include "core/sph/pair_records-inl.h"
#include "core/sph/pair_sums.h"
#include "core/sph/particles.h"

#include <hwy/highway.h>
#include <tbb/cache_aligned_allocator.h>

#include <algorithm>
#include <array>
#include <type_traits>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace smelt {
namespace HWY_NAMESPACE {

/// Where the first pass keeps its sums: those of the flow, of the neighbours' places and of heat.
template <int Dim, bool with_stress, bool with_heat, bool with_xsph>
struct RateIndex {
  static constexpr int density_rate = 0, velocity_moment = 1, xsph = velocity_moment + (with_stress ? Dim * Dim : 0),
                       n_flow = xsph + (with_xsph ? Dim : 0);
  static constexpr int position_moment = n_flow, n_places = with_stress || with_heat ? n_symmetric<Dim> : 0;
  static constexpr int heat = n_flow + n_places, moment_trace = heat + 1, heat_imbalance = heat + 2,
                       n_heat = with_heat ? 2 + Dim : 0, n_sums = heat + n_heat;
};

/// Adds sum V_j w (v_j - v_i) (x) grad_w_ij for a vector of neighbours, `weight` being V_j w F.
template <int Dim, typename Real, typename Pair>
HWY_INLINE void add_velocity_moment(const Pair& pair, Simd<Real> weight, Simd<Real>* moment) {
  // v_j - v_i = -v_ij.
  for (int b = 0; b < Dim; ++b) {
    const auto weighted = hn::Mul(weight, pair.x_ij[b]);
    for (int a = 0; a < Dim; ++a) moment[a * Dim + b] = hn::NegMulAdd(pair.v_ij[a], weighted, moment[a * Dim + b]);
  }
}

/// What the stress of particle `i` sees where some neighbour is too thin for it to see in full.
template <typename PairKernel, int Dim, typename Real>
SightedSums<Dim, Real> sighted_sums(const PairFields<Dim, Real>& fields, const PairKernel& kernel,
                                    const NeighbourLists::Row& row, std::size_t i) {
  const Tag<Real> d;
  using Fields = PairFields<Dim, Real>;
  constexpr int position_at = Dim * Dim;
  const Real* record_i = fields.record(i);
  const auto sight_i = hn::Set(d, static_cast<Real>(sight_of_thinner) / record_i[Fields::rest_viscosity_at]);
  const auto add_pairs = [&](const std::int32_t* begins, Simd<Real>* sum) HWY_ATTR __attribute__((always_inline)) {
    const Neighbours<Dim, Real> pair(record_i, fields.records.data(), begins);
    const auto eta_j = load_field<Dim, Real, Fields::rest_viscosity_at>(fields, begins);
    const auto sight = hn::Min(hn::Set(d, Real(1)), hn::Mul(sight_i, eta_j));
    const auto volume_f = hn::Mul(pair.volume, kernel.gradient_over_r(dot<Dim, Real>(pair.x_ij, pair.x_ij)));
    const auto weight = hn::Mul(volume_f, sight);
    add_velocity_moment<Dim, Real>(pair, weight, sum);
    add_position_moment<Dim, Real>(pair, weight, sum + position_at);
  };
  Real total[position_at + n_symmetric<Dim>];
  sum_row<position_at + n_symmetric<Dim>>(row, total, add_pairs);
  SightedSums<Dim, Real> sums;
  std::copy_n(total, Dim * Dim, sums.velocity_moment.begin());
  std::copy_n(total + position_at, n_symmetric<Dim>, sums.position_moment.begin());
  return sums;
}

/// A vector of neighbours as the sums of the first pass need them: a loop of its own finds this for a whole row, as one
/// that did both would have more numbers in use than there are registers (docs/performance.md).
template <int Dim, typename Real>
struct WeighedPairs {
  Simd<Real> x_ij[Dim], v_ij[Dim], r2;
  Simd<Real> volume_f, mass_f;  ///< V_j F and m_j F
  Simd<Real> xsph_weight;       ///< m_j (1/rho_i + 1/rho_j) W_ij
};

/// Those whose records begin at `begins`, of a particle whose record is `record_i`.
template <typename PairKernel, int Dim, typename Real, bool with_xsph>
HWY_INLINE void weigh_pairs(const PairKernel& kernel, const Real* record_i, const Real* records,
                            const std::int32_t* begins, WeighedPairs<Dim, Real>& out) {
  const Neighbours<Dim, Real> pair(record_i, records, begins);
  const auto r2 = dot<Dim, Real>(pair.x_ij, pair.x_ij);
  out.volume_f = hn::Mul(pair.volume, kernel.gradient_over_r(r2));
  out.mass_f = hn::Mul(pair.density, out.volume_f);
  out.r2 = r2;
  for (int a = 0; a < Dim; ++a) {
    out.x_ij[a] = pair.x_ij[a];
    out.v_ij[a] = pair.v_ij[a];
  }
  if constexpr (with_xsph) {
    const auto inverse_density_i = hn::Set(Tag<Real>(), 1 / record_i[PairFields<Dim, Real>::density_at]);
    const auto mass_ratio = hn::MulAdd(hn::Mul(pair.volume, pair.density), inverse_density_i, pair.volume);
    out.xsph_weight = hn::Mul(mass_ratio, kernel.value(r2));
  }
}

/// Adds what neighbours conduct to the particle, then the trace and the imbalance that its balance takes, from their
/// fields `heat_j` from heat_at on.
template <int Dim, typename Real, HeatTerms heat_terms>
HWY_INLINE void add_heat(const WeighedPairs<Dim, Real>& pair, const Real* record_i, const Simd<Real>* heat_j,
                         Simd<Real>* sum) {
  const Tag<Real> d;
  using Fields = PairFields<Dim, Real>;
  constexpr int heat = 0, moment_trace = 1, imbalance_at = 2;
  const auto of_i = [&](int field) HWY_ATTR { return hn::Set(d, record_i[field]); };
  const auto of_j = [&](int field) HWY_ATTR { return heat_j[field - Fields::heat_at]; };
  auto along_i = hn::Mul(pair.x_ij[0], of_i(Fields::balance_at));
  auto along_j = hn::Mul(pair.x_ij[0], of_j(Fields::balance_at));
  for (int a = 1; a < Dim; ++a) {
    along_i = hn::MulAdd(pair.x_ij[a], of_i(Fields::balance_at + a), along_i);
    along_j = hn::MulAdd(pair.x_ij[a], of_j(Fields::balance_at + a), along_j);
  }
  const auto one = hn::Set(d, Real(1));
  const auto unlimited = hn::Add(one, hn::Sub(along_i, along_j));
  const auto balance = hn::Min(hn::Max(unlimited, hn::Set(d, Real(0.2))), hn::Set(d, Real(1.8)));
  const auto balanced_f = hn::Mul(pair.volume_f, balance);
  sum[moment_trace] = hn::NegMulAdd(balanced_f, pair.r2, sum[moment_trace]);
  const auto imbalance = hn::NegMulAdd(pair.volume_f, along_j, pair.volume_f);
  for (int a = 0; a < Dim; ++a) sum[imbalance_at + a] = hn::MulAdd(imbalance, pair.x_ij[a], sum[imbalance_at + a]);
  const auto t_ij = hn::Sub(of_i(Fields::heat_at), of_j(Fields::heat_at));
  const auto inverse_trace = hn::Add(of_i(Fields::inverse_trace_at), of_j(Fields::inverse_trace_at));
  auto conducted = hn::Mul(hn::Mul(balanced_f, t_ij), inverse_trace);
  if constexpr (heat_terms == HeatTerms::mixed) {
    const auto l_j = of_j(Fields::conductivity_at);
    const auto l_sum = hn::Max(hn::Add(of_i(Fields::conductivity_at), l_j), hn::Set(d, Real(1e-30)));
    conducted = hn::Mul(conducted, hn::Div(hn::Add(l_j, l_j), l_sum));
  }
  sum[heat] = hn::Add(conducted, sum[heat]);
}

/// Its particle's rates from what was added up over a row.
template <int Dim, typename Real, bool with_stress, bool with_heat, bool with_xsph>
void write_rates(const Real* total, RateSums<Dim, Real>& out) {
  using At = RateIndex<Dim, with_stress, with_heat, with_xsph>;
  out.density_rate = total[At::density_rate];
  if constexpr (with_stress) std::copy_n(total + At::velocity_moment, Dim * Dim, out.velocity_moment.begin());
  if constexpr (with_stress || with_heat)
    std::copy_n(total + At::position_moment, n_symmetric<Dim>, out.position_moment.begin());
  if constexpr (with_heat) {
    // Twice, and the half of a mean.
    out.heat = total[At::heat];
    out.moment_trace = total[At::moment_trace] / Dim;
    std::copy_n(total + At::heat_imbalance, Dim, out.heat_imbalance.begin());
  }
  if constexpr (with_xsph)
    for (int a = 0; a < Dim; ++a) out.xsph[a] = total[At::xsph + a] / 2;
}

template <typename PairKernel, int Dim, typename Real, bool with_stress, bool with_sight, HeatTerms heat_terms,
          bool with_xsph>
void rate_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, double h, std::size_t begin,
               std::size_t end, RateSums<Dim, Real>* sums, [[maybe_unused]] SightedSums<Dim, Real>* sighted) {
  const Tag<Real> d;
  const PairKernel kernel(h);
  constexpr bool with_heat = heat_terms != HeatTerms::none;
  using Fields = PairFields<Dim, Real>;
  using At = RateIndex<Dim, with_stress, with_heat, with_xsph>;
  const Real* records = fields.records.data();
  std::vector<std::int32_t> buffer(lists.room());
  std::vector<WeighedPairs<Dim, Real>, tbb::cache_aligned_allocator<WeighedPairs<Dim, Real>>> weighed(
      lists.room() / lanes<Real> + 1);
  for (std::size_t i = begin; i < end; ++i) {
    const Real* record_i = fields.record(i);
    [[maybe_unused]] auto thinnest = hn::Set(d, record_i[Fields::rest_viscosity_at]);
    fetch_ahead<false>(fields, lists, i);
    const NeighbourLists::Row row = fields.read_row(lists, i, buffer.data());
    for (std::size_t k = 0; k < row.neighbours.size(); k += lanes<Real>)
      weigh_pairs<PairKernel, Dim, Real, with_xsph>(kernel, record_i, records, row.padded.data() + k,
                                                    weighed[k / lanes<Real>]);
    const auto weighed_at = [&](const std::int32_t* begins) HWY_ATTR -> const WeighedPairs<Dim, Real>& {
      return weighed[static_cast<std::size_t>(begins - row.padded.data()) / lanes<Real>];
    };
    const auto add_flow = [&](const std::int32_t* begins, Simd<Real>* sum) HWY_ATTR __attribute__((always_inline)) {
      const WeighedPairs<Dim, Real>& pair = weighed_at(begins);
      sum[At::density_rate] = hn::MulAdd(pair.mass_f, dot<Dim, Real>(pair.v_ij, pair.x_ij), sum[At::density_rate]);
      if constexpr (with_stress) add_velocity_moment<Dim, Real>(pair, pair.volume_f, sum + At::velocity_moment);
      if constexpr (with_xsph)
        for (int a = 0; a < Dim; ++a)
          sum[At::xsph + a] = hn::NegMulAdd(pair.v_ij[a], pair.xsph_weight, sum[At::xsph + a]);
    };
    const auto add_places = [&](const std::int32_t* begins, Simd<Real>* sum) HWY_ATTR __attribute__((always_inline)) {
      const WeighedPairs<Dim, Real>& pair = weighed_at(begins);
      add_position_moment<Dim, Real>(pair, pair.volume_f, sum);
      if constexpr (with_sight && !with_heat)
        thinnest = hn::Min(thinnest, load_field<Dim, Real, Fields::rest_viscosity_at>(fields, begins));
    };
    const auto add_heats = [&](const std::int32_t* begins, Simd<Real>* sum) HWY_ATTR __attribute__((always_inline)) {
      constexpr int n_heat = with_sight ? Fields::rest_viscosity_at + 1 - Fields::heat_at : Fields::n_heat;
      Simd<Real> heat_j[padded_fields(n_heat)];
      load_fields<Fields::record_size, n_heat>(records, Fields::heat_at, begins, heat_j);
      if constexpr (with_sight) thinnest = hn::Min(thinnest, heat_j[Fields::rest_viscosity_at - Fields::heat_at]);
      add_heat<Dim, Real, heat_terms>(weighed_at(begins), record_i, heat_j, sum);
    };
    Real total[At::n_sums];
    const auto flow = sum_group<At::n_flow>(add_flow);
    if constexpr (with_heat)
      sum_row_in_groups(row, total, flow, sum_group<At::n_places>(add_places), sum_group<At::n_heat>(add_heats));
    else if constexpr (with_stress)
      sum_row_in_groups(row, total, flow, sum_group<At::n_places>(add_places));
    else
      sum_row_in_groups(row, total, flow);
    RateSums<Dim, Real>& out = sums[i - begin];
    write_rates<Dim, Real, with_stress, with_heat, with_xsph>(total, out);
    if constexpr (with_sight) {
      const Real least = hn::GetLane(hn::MinOfLanes(d, thinnest));
      if (static_cast<Real>(sight_of_thinner) * least < record_i[Fields::rest_viscosity_at])
        sighted[i - begin] = sighted_sums<PairKernel, Dim, Real>(fields, kernel, row, i);
      else
        sighted[i - begin] = {out.velocity_moment, out.position_moment};
    }
  }
}

/// Picks the loop compiled for just the terms in use. Double precision serves studies, not speed: there XSPH is always
/// summed, and uniform heat is mixed heat whose pairs are multiplied by exactly 1.
template <typename PairKernel, int Dim, typename Real>
void select_rate_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, const PairTerms& terms,
                      double h, std::size_t begin, std::size_t end, RateSums<Dim, Real>* sums,
                      SightedSums<Dim, Real>* sighted) {
  const auto run = [&](auto stress, auto sight, auto heat, auto xsph) HWY_ATTR {
    rate_sums<PairKernel, Dim, Real, stress.value, sight.value, heat.value, xsph.value>(fields, lists, h, begin, end,
                                                                                        sums, sighted);
  };
  constexpr bool few_loops = std::is_same_v<Real, double>;
  const auto with_xsph = [&](auto stress, auto sight, auto heat) HWY_ATTR {
    if constexpr (few_loops) return run(stress, sight, heat, std::true_type{});
    terms.xsph ? run(stress, sight, heat, std::true_type{}) : run(stress, sight, heat, std::false_type{});
  };
  const auto with_heat = [&](auto stress, auto sight) HWY_ATTR {
    switch (terms.heat) {
      case HeatTerms::none:
        return with_xsph(stress, sight, std::integral_constant<HeatTerms, HeatTerms::none>{});
      case HeatTerms::uniform:
        if constexpr (!few_loops)
          return with_xsph(stress, sight, std::integral_constant<HeatTerms, HeatTerms::uniform>{});
        [[fallthrough]];
      case HeatTerms::mixed:
        return with_xsph(stress, sight, std::integral_constant<HeatTerms, HeatTerms::mixed>{});
    }
  };
  if (terms.stress && terms.sight) return with_heat(std::true_type{}, std::true_type{});
  terms.stress ? with_heat(std::true_type{}, std::false_type{}) : with_heat(std::false_type{}, std::false_type{});
}

}  // namespace HWY_NAMESPACE
}  // namespace smelt
HWY_AFTER_NAMESPACE();

#endif  // SMELT_RATE_SUMS_INL_H
