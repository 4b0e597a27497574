// The pair loops for one instruction set; included once per target by pair_sums.cpp.
#if defined(SMELT_PAIR_SUMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SMELT_PAIR_SUMS_INL_H
#undef SMELT_PAIR_SUMS_INL_H
#else
#define SMELT_PAIR_SUMS_INL_H
#endif

#include "core/sph/pair_records-inl.h"
#include "core/sph/pair_sums.h"
#include "core/sph/particles.h"

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace smelt {
namespace HWY_NAMESPACE {

/// Where the first pass keeps its sums.
template <int Dim>
struct RateIndex {
  static constexpr int density_rate = 0, velocity_moment = 1, position_moment = velocity_moment + Dim * Dim,
                       heat = position_moment + n_symmetric<Dim>, moment_trace = heat + 1, heat_imbalance = moment_trace + 1,
                       xsph = heat_imbalance + Dim, n_sums = xsph + Dim;
};

/// Adds sum V_j w (v_j - v_i) (x) grad_w_ij and sum V_j w (x_j - x_i) (x) grad_w_ij for a vector of neighbours, `weight` being V_j w F.
template <int Dim, typename Real, bool with_velocity, typename Pair>
HWY_INLINE void add_moments(const Pair& pair, Simd<Real> weight, Simd<Real>* velocity_moment, Simd<Real>* position_moment) {
  // v_j - v_i = -v_ij and x_j - x_i = -x_ij: one sign for all.
  for (int b = 0; b < Dim; ++b) {
    const auto weighted = hn::Mul(weight, pair.x_ij[b]);
    if constexpr (with_velocity)
      for (int a = 0; a < Dim; ++a) velocity_moment[a * Dim + b] = hn::NegMulAdd(pair.v_ij[a], weighted, velocity_moment[a * Dim + b]);
    for (int a = 0; a <= b; ++a) {
      auto& moment = position_moment[symmetric_index<Dim>(a, b)];
      moment = hn::NegMulAdd(pair.x_ij[a], weighted, moment);
    }
  }
}

/// What the stress of particle `i` sees where some neighbour is too thin for it to see in full.
template <typename PairKernel, int Dim, typename Real>
SightedSums<Dim, Real> sighted_sums(const PairFields<Dim, Real>& fields, const PairKernel& kernel, const NeighbourLists::Row& row, std::size_t i) {
  const Tag<Real> d;
  using Fields = PairFields<Dim, Real>;
  const Real* records = fields.records.data();
  constexpr int stride = Fields::stride_of(true), position_at = Dim * Dim;
  const Real* record_i = records + i * stride;
  const auto sight_i = hn::Set(d, static_cast<Real>(sight_of_thinner) / record_i[Fields::rest_viscosity_at]);
  const auto add_pairs = [&](const std::int32_t* index, Simd<Real>* sum) HWY_ATTR __attribute__((always_inline)) {
    const Neighbours<Dim, Real> pair(record_i, records, stride, index);
    const auto eta_j = load_field<Fields::rest_viscosity_at>(records, stride, index);
    const auto sight = hn::Min(hn::Set(d, Real(1)), hn::Mul(sight_i, eta_j));
    const auto volume_f = hn::Mul(pair.volume, kernel.gradient_over_r(dot<Dim, Real>(pair.x_ij, pair.x_ij)));
    add_moments<Dim, Real, true>(pair, hn::Mul(volume_f, sight), sum, sum + position_at);
  };
  Real total[position_at + n_symmetric<Dim>];
  sum_row(row, total, add_pairs);
  SightedSums<Dim, Real> sums;
  std::copy_n(total, Dim * Dim, sums.velocity_moment.begin());
  std::copy_n(total + position_at, n_symmetric<Dim>, sums.position_moment.begin());
  return sums;
}

/// A vector of neighbours as the sums of the first pass need them: a loop of its own finds this for a whole row, as one
/// that did both would have more numbers in use than there are registers.
template <int Dim, typename Real>
struct WeighedPairs {
  Simd<Real> x_ij[Dim], v_ij[Dim], r2;
  Simd<Real> volume_f, mass_f;  ///< V_j F and m_j F
  Simd<Real> xsph_weight;       ///< m_j (1/rho_i + 1/rho_j) W_ij
};

template <typename PairKernel, int Dim, typename Real, bool with_stress, bool with_sight, HeatTerms heat_terms, bool with_xsph>
void rate_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, double h, std::size_t begin,
               std::size_t end, RateSums<Dim, Real>* sums, [[maybe_unused]] SightedSums<Dim, Real>* sighted) {
  const Tag<Real> d;
  const PairKernel kernel(h);
  constexpr bool with_heat = heat_terms != HeatTerms::none;
  using Fields = PairFields<Dim, Real>;
  using At = RateIndex<Dim>;
  const Real* records = fields.records.data();
  constexpr int stride = Fields::stride_of(with_stress);
  [[maybe_unused]] const auto least_balance = hn::Set(d, Real(0.2)), most_balance = hn::Set(d, Real(1.8));
  [[maybe_unused]] const auto one = hn::Set(d, Real(1)), least_sum = hn::Set(d, Real(1e-30));
  std::vector<std::int32_t> buffer(lists.room());
  std::vector<WeighedPairs<Dim, Real>, tbb::cache_aligned_allocator<WeighedPairs<Dim, Real>>> weighed(lists.room() / lanes<Real> + 1);
  for (std::size_t i = begin; i < end; ++i) {
    const Real* record_i = records + i * stride;
    [[maybe_unused]] const auto inverse_density_i = hn::Set(d, 1 / record_i[Fields::density_at]);
    [[maybe_unused]] auto thinnest = hn::Set(d, record_i[Fields::rest_viscosity_at]);
    const auto weigh_pairs = [&](const std::int32_t* index, WeighedPairs<Dim, Real>& out) HWY_ATTR __attribute__((always_inline)) {
      const Neighbours<Dim, Real> pair(record_i, records, stride, index);
      const auto r2 = dot<Dim, Real>(pair.x_ij, pair.x_ij);
      out.volume_f = hn::Mul(pair.volume, kernel.gradient_over_r(r2));
      out.mass_f = hn::Mul(pair.density, out.volume_f);
      out.r2 = r2;
      for (int a = 0; a < Dim; ++a) {
        out.x_ij[a] = pair.x_ij[a];
        out.v_ij[a] = pair.v_ij[a];
      }
      if constexpr (with_xsph) {
        const auto mass_ratio = hn::MulAdd(hn::Mul(pair.volume, pair.density), inverse_density_i, pair.volume);
        out.xsph_weight = hn::Mul(mass_ratio, kernel.value(r2));
      }
    };
    const NeighbourLists::Row row = lists.read(i, buffer.data());
    const auto add_pairs = [&](const std::int32_t* index, Simd<Real>* sum) HWY_ATTR __attribute__((always_inline)) {
      const WeighedPairs<Dim, Real>& pair = weighed[static_cast<std::size_t>(index - row.padded.data()) / lanes<Real>];
      const auto &x_ij = pair.x_ij, &v_ij = pair.v_ij;
      const auto volume_f = pair.volume_f;
      sum[At::density_rate] = hn::MulAdd(pair.mass_f, dot<Dim, Real>(v_ij, x_ij), sum[At::density_rate]);
      if constexpr (with_stress || with_heat) {
        add_moments<Dim, Real, with_stress>(pair, volume_f, sum + At::velocity_moment, sum + At::position_moment);
      }
      if constexpr (with_sight && !with_heat)
        thinnest = hn::Min(thinnest, load_field<Fields::rest_viscosity_at>(records, stride, index));
      if constexpr (with_heat) {
        constexpr int n_heat = with_sight ? Fields::rest_viscosity_at + 1 - Fields::heat_at : Fields::n_heat;
        Simd<Real> heat_j[padded_fields(n_heat)];
        load_fields<Fields::heat_at, n_heat>(records, stride, index, heat_j);
        const auto of_i = [&](int field) HWY_ATTR { return hn::Set(d, record_i[field]); };
        const auto of_j = [&](int field) HWY_ATTR { return heat_j[field - Fields::heat_at]; };
        if constexpr (with_sight) thinnest = hn::Min(thinnest, of_j(Fields::rest_viscosity_at));
        auto along_i = hn::Mul(x_ij[0], of_i(Fields::balance_at));
        auto along_j = hn::Mul(x_ij[0], of_j(Fields::balance_at));
        for (int a = 1; a < Dim; ++a) {
          along_i = hn::MulAdd(x_ij[a], of_i(Fields::balance_at + a), along_i);
          along_j = hn::MulAdd(x_ij[a], of_j(Fields::balance_at + a), along_j);
        }
        const auto balance = hn::Min(hn::Max(hn::Add(one, hn::Sub(along_i, along_j)), least_balance), most_balance);
        const auto balanced_f = hn::Mul(volume_f, balance);
        sum[At::moment_trace] = hn::NegMulAdd(balanced_f, pair.r2, sum[At::moment_trace]);
        const auto imbalance = hn::NegMulAdd(volume_f, along_j, volume_f);
        for (int a = 0; a < Dim; ++a) sum[At::heat_imbalance + a] = hn::MulAdd(imbalance, x_ij[a], sum[At::heat_imbalance + a]);
        const auto t_ij = hn::Sub(of_i(Fields::heat_at), of_j(Fields::heat_at));
        const auto inverse_trace = hn::Add(of_i(Fields::inverse_trace_at), of_j(Fields::inverse_trace_at));
        auto conducted = hn::Mul(hn::Mul(balanced_f, t_ij), inverse_trace);
        if constexpr (heat_terms == HeatTerms::mixed) {
          const auto l_j = of_j(Fields::conductivity_at);
          const auto l_sum = hn::Max(hn::Add(of_i(Fields::conductivity_at), l_j), least_sum);
          conducted = hn::Mul(conducted, hn::Div(hn::Add(l_j, l_j), l_sum));
        }
        sum[At::heat] = hn::Add(conducted, sum[At::heat]);
      }
      if constexpr (with_xsph)
        for (int a = 0; a < Dim; ++a) sum[At::xsph + a] = hn::NegMulAdd(v_ij[a], pair.xsph_weight, sum[At::xsph + a]);
    };
    Real total[At::n_sums];
    for (std::size_t k = 0; k < row.neighbours.size(); k += lanes<Real>)
      weigh_pairs(row.padded.data() + k, weighed[k / lanes<Real>]);
    sum_row(row, total, add_pairs);

    RateSums<Dim, Real>& out = sums[i - begin];
    out.density_rate = total[At::density_rate];
    if constexpr (with_stress) std::copy_n(total + At::velocity_moment, Dim * Dim, out.velocity_moment.begin());
    if constexpr (with_stress || with_heat) std::copy_n(total + At::position_moment, n_symmetric<Dim>, out.position_moment.begin());
    if constexpr (with_sight) {
      const Real least = hn::GetLane(hn::MinOfLanes(d, thinnest));
      if (static_cast<Real>(sight_of_thinner) * least < record_i[Fields::rest_viscosity_at])
        sighted[i - begin] = sighted_sums<PairKernel, Dim, Real>(fields, kernel, row, i);
      else
        sighted[i - begin] = {out.velocity_moment, out.position_moment};
    }
    if constexpr (with_heat) {
      // Twice, and the half of a mean.
      out.heat = total[At::heat];
      out.moment_trace = total[At::moment_trace] / Dim;
      std::copy_n(total + At::heat_imbalance, Dim, out.heat_imbalance.begin());
    }
    if constexpr (with_xsph)
      for (int a = 0; a < Dim; ++a) out.xsph[a] = total[At::xsph + a] / 2;
  }
}

template <typename PairKernel, int Dim, typename Real, bool with_stress, bool with_sight, bool with_hourglass>
void force_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, const ForceParameters& parameters,
                std::size_t begin, std::size_t end, std::array<Real, Dim>* acceleration) {
  const Tag<Real> d;
  const double h = parameters.smoothing_length;
  const PairKernel kernel(h);
  using Fields = PairFields<Dim, Real>;
  const Real* records = fields.records.data();
  constexpr int stride = Fields::stride_of(with_stress);
  constexpr int way_at = Dim, n_sums = with_stress ? 2 * Dim : Dim;  // the force is first
  const auto soft = hn::Set(d, static_cast<Real>(0.01 * h * h));
  // Pi_ij = -alpha c mu_ij / (0.5 (rho_i + rho_j)), mu_ij = h v_ij.x_ij / (r^2 + 0.01 h^2) where they approach.
  const auto damping = hn::Set(d, static_cast<Real>(2.0 * parameters.artificial_viscosity * parameters.sound_speed * h));
  [[maybe_unused]] const auto hourglass = hn::Set(d, static_cast<Real>(2 * (Dim + 2)));
  const auto one = hn::Set(d, Real(1));
  std::vector<std::int32_t> buffer(lists.room());
  for (std::size_t i = begin; i < end; ++i) {
    const Real* record_i = records + i * stride;
    const auto density_i = hn::Set(d, record_i[Fields::density_at]);
    const auto inverse_density_i = hn::Set(d, 1 / record_i[Fields::density_at]);
    // One load of four for the pressure and what sight takes.
    constexpr int eta_at = Fields::rest_viscosity_of_forces_at, pressure_at = eta_at, n_pressure = Fields::specific_pressure_at + 1 - pressure_at;
    [[maybe_unused]] const auto sight_of_i = hn::Set(d, static_cast<Real>(sight_of_thinner) * record_i[eta_at]);
    [[maybe_unused]] const auto sight_i = hn::Set(d, static_cast<Real>(sight_of_thinner) * record_i[eta_at + 1]);
    const auto add_pairs = [&](const std::int32_t* index, Simd<Real>* sum) HWY_ATTR __attribute__((always_inline)) {
      const Neighbours<Dim, Real> pair(record_i, records, stride, index);
      const auto &x_ij = pair.x_ij, &v_ij = pair.v_ij;
      Simd<Real> pressure_j[padded_fields(n_pressure)];
      load_fields<pressure_at, n_pressure>(records, stride, index, pressure_j);
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
        load_fields<Fields::stress_at, n_stress>(records, stride, index, stress_j);
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
          const auto of_i = [&](int field) HWY_ATTR { return hn::Set(d, record_i[field]); };
          const auto of_j = [&](int field) HWY_ATTR { return stress_j[field - Fields::stress_at]; };
          const auto pair_sum = [&](int field) HWY_ATTR {
            if constexpr (with_sight) return hn::MulAdd(scale_i, of_i(field), hn::Mul(scale_j, of_j(field)));
            return hn::Add(of_i(field), of_j(field));
          };
          auto unseen = hn::Mul(pair_sum(Fields::hourglass_at), v_x);
          for (int m = 0; m < n_symmetric<Dim>; ++m) {
            const auto [a, b] = symmetric_entry<Dim>(m);
            unseen = hn::NegMulAdd(pair_sum(Fields::hourglass_at + 1 + m), hn::Mul(x_ij[a], x_ij[b]), unseen);
          }
          const auto strength = with_sight ? hourglass : hn::Mul(scale, hourglass);
          along = hn::MulAdd(hn::Mul(strength, hn::Mul(inverse, density_sum)), unseen, along);
        }
      }
      for (int a = 0; a < Dim; ++a) sum[a] = hn::MulAdd(along, x_ij[a], sum[a]);
    };
    Real total[n_sums];
    sum_row(lists.read(i, buffer.data()), total, add_pairs);
    for (int a = 0; a < Dim; ++a) {
      acceleration[i - begin][a] = total[a];
      if constexpr (with_stress)
        for (int b = 0; b < Dim; ++b) acceleration[i - begin][a] += record_i[Fields::stress_at + a * Dim + b] * total[way_at + b];
    }
  }
}

template <typename PairKernel, int Dim, typename Real>
void gas_force_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, const GasForceParameters& parameters,
                    std::size_t begin, std::size_t end, std::array<Real, Dim>* acceleration, Real* energy_rate) {
  const Tag<Real> d;
  const double h = parameters.smoothing_length;
  const PairKernel kernel(h);
  using Fields = PairFields<Dim, Real>;
  const Real* records = fields.records.data();
  constexpr int stride = Fields::stride_of(false);
  const auto soft = hn::Set(d, static_cast<Real>(0.01 * h * h));
  const auto alpha = hn::Set(d, static_cast<Real>(parameters.artificial_viscosity));
  const auto two_beta = hn::Set(d, static_cast<Real>(2.0 * parameters.quadratic_artificial_viscosity));
  std::vector<std::int32_t> buffer(lists.room());
  for (std::size_t i = begin; i < end; ++i) {
    const Real* record_i = records + i * stride;
    const auto add_pairs = [&](const std::int32_t* index, Simd<Real>* sum) HWY_ATTR __attribute__((always_inline)) {
      const Neighbours<Dim, Real> pair(record_i, records, stride, index);
      const auto specific_pressure_j = load_field<Fields::specific_pressure_at>(records, stride, index);
      const auto sound_speed_j = load_field<Fields::sound_speed_at>(records, stride, index);
      const auto r2 = dot<Dim, Real>(pair.x_ij, pair.x_ij);
      const auto v_x = dot<Dim, Real>(pair.v_ij, pair.x_ij);
      // Twice c_ij and twice rho_ij: the halves cancel but for beta's.
      const auto mu = hn::Div(hn::Mul(hn::Set(d, static_cast<Real>(h)), hn::Min(v_x, hn::Zero(d))), hn::Add(r2, soft));
      const auto sound = hn::Add(hn::Set(d, record_i[Fields::sound_speed_at]), sound_speed_j);
      const auto density = hn::Add(hn::Set(d, record_i[Fields::density_at]), pair.density);
      const auto pi = hn::Div(hn::Mul(mu, hn::MulSub(two_beta, mu, hn::Mul(alpha, sound))), density);
      const auto pressure = hn::Add(hn::Add(hn::Set(d, record_i[Fields::specific_pressure_at]), specific_pressure_j), pi);
      const auto mass_f = hn::Mul(hn::Mul(pair.density, pair.volume), kernel.gradient_over_r(r2));
      const auto weight = hn::Mul(mass_f, pressure);
      for (int a = 0; a < Dim; ++a) sum[a] = hn::NegMulAdd(weight, pair.x_ij[a], sum[a]);
      sum[Dim] = hn::MulAdd(weight, v_x, sum[Dim]);
    };
    Real total[Dim + 1];  // the force and the energy
    sum_row(lists.read(i, buffer.data()), total, add_pairs);
    std::copy_n(total, Dim, acceleration[i - begin].begin());
    energy_rate[i - begin] = Real(0.5) * total[Dim];
  }
}

template <typename PairKernel, int Dim, typename Real>
void density_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, double h, std::size_t begin,
                  std::size_t end, DensitySums<Real>* sums) {
  const Tag<Real> d;
  const PairKernel kernel(h);
  using Fields = PairFields<Dim, Real>;
  std::vector<std::int32_t> buffer(lists.room());
  for (std::size_t i = begin; i < end; ++i) {
    const Real* record_i = fields.record(i);
    const NeighbourLists::Row row = lists.read(i, buffer.data());
    const std::int32_t* row_end = row.neighbours.data() + row.neighbours.size();
    const auto add_pairs = [&](const std::int32_t* index, Simd<Real>* sum) HWY_ATTR __attribute__((always_inline)) {
      const Neighbours<Dim, Real> pair(record_i, fields.records.data(), fields.stride, index);
      // The padding is the particle itself, whose W is not nothing: it counts once, below.
      const auto n_left = static_cast<std::size_t>(std::max<std::ptrdiff_t>(row_end - index, 0));
      const auto w = hn::IfThenElseZero(hn::FirstN(d, n_left), kernel.value(dot<Dim, Real>(pair.x_ij, pair.x_ij)));
      const auto volume_w = hn::Mul(pair.volume, w);
      sum[0] = hn::MulAdd(pair.density, volume_w, sum[0]);
      sum[1] = hn::Add(volume_w, sum[1]);
    };
    Real total[2];
    sum_row(row, total, add_pairs);
    const Real self = record_i[Fields::volume_at] * hn::GetLane(kernel.value(hn::Zero(d)));
    sums[i - begin].mass = total[0] + record_i[Fields::density_at] * self;
    sums[i - begin].volume = total[1] + self;
  }
}

/// Picks the loop compiled for just the terms in use.
template <typename PairKernel, int Dim, typename Real>
void select_rate_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, const PairTerms& terms, double h,
                      std::size_t begin, std::size_t end, RateSums<Dim, Real>* sums, SightedSums<Dim, Real>* sighted) {
  const auto run = [&](auto stress, auto sight, auto heat, auto xsph) HWY_ATTR {
    rate_sums<PairKernel, Dim, Real, stress.value, sight.value, heat.value, xsph.value>(fields, lists, h, begin, end, sums, sighted);
  };
  const auto with_xsph = [&](auto stress, auto sight, auto heat) HWY_ATTR {
    terms.xsph ? run(stress, sight, heat, std::true_type{}) : run(stress, sight, heat, std::false_type{});
  };
  const auto with_heat = [&](auto stress, auto sight) HWY_ATTR {
    switch (terms.heat) {
      case HeatTerms::none: return with_xsph(stress, sight, std::integral_constant<HeatTerms, HeatTerms::none>{});
      case HeatTerms::uniform: return with_xsph(stress, sight, std::integral_constant<HeatTerms, HeatTerms::uniform>{});
      case HeatTerms::mixed: return with_xsph(stress, sight, std::integral_constant<HeatTerms, HeatTerms::mixed>{});
    }
  };
  if (terms.stress && terms.sight) return with_heat(std::true_type{}, std::true_type{});
  terms.stress ? with_heat(std::true_type{}, std::false_type{}) : with_heat(std::false_type{}, std::false_type{});
}

template <typename PairKernel, int Dim, typename Real>
void select_force_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, const PairTerms& terms,
                       const ForceParameters& parameters, std::size_t begin, std::size_t end,
                       std::array<Real, Dim>* acceleration) {
  const auto run = [&](auto stress, auto sight, auto hourglass) HWY_ATTR {
    force_sums<PairKernel, Dim, Real, stress.value, sight.value, hourglass.value>(fields, lists, parameters, begin, end, acceleration);
  };
  const auto with_sight = [&](auto hourglass) HWY_ATTR {
    terms.sight ? run(std::true_type{}, std::true_type{}, hourglass) : run(std::true_type{}, std::false_type{}, hourglass);
  };
  if (terms.hourglass)
    with_sight(std::true_type{});
  else if (terms.stress)
    with_sight(std::false_type{});
  else
    run(std::false_type{}, std::false_type{}, std::false_type{});
}

#define SMELT_INSTANTIATE(Dim, Real, suffix)                                                                           \
  inline void rate_sums_##suffix(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,                     \
                                 const PairTerms& terms, double h, std::size_t begin, std::size_t end,                 \
                                 RateSums<Dim, Real>* sums, SightedSums<Dim, Real>* sighted) {                         \
    with_kernel<Dim, Real>(terms.kernel, [&](auto kernel) HWY_ATTR {                                                   \
      select_rate_sums<typename decltype(kernel)::type, Dim, Real>(fields, lists, terms, h, begin, end, sums, sighted); \
    });                                                                                                                \
  }                                                                                                                    \
  inline void force_sums_##suffix(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,                    \
                                  const PairTerms& terms, const ForceParameters& parameters, std::size_t begin,        \
                                  std::size_t end, std::array<Real, Dim>* acceleration) {                              \
    with_kernel<Dim, Real>(terms.kernel, [&](auto kernel) HWY_ATTR {                                                   \
      select_force_sums<typename decltype(kernel)::type, Dim, Real>(fields, lists, terms, parameters, begin, end,      \
                                                                    acceleration);                                     \
    });                                                                                                                \
  }                                                                                                                    \
  inline void gas_force_sums_##suffix(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,                \
                                      KernelType type, const GasForceParameters& parameters, std::size_t begin,        \
                                      std::size_t end, std::array<Real, Dim>* acceleration, Real* energy_rate) {       \
    with_kernel<Dim, Real>(type, [&](auto kernel) HWY_ATTR {                                                           \
      gas_force_sums<typename decltype(kernel)::type, Dim, Real>(fields, lists, parameters, begin, end, acceleration,  \
                                                                 energy_rate);                                         \
    });                                                                                                                \
  }                                                                                                                    \
  inline void density_sums_##suffix(const PairFields<Dim, Real>& fields, const NeighbourLists& lists,                  \
                                    KernelType type, double h, std::size_t begin, std::size_t end,                     \
                                    DensitySums<Real>* sums) {                                                         \
    with_kernel<Dim, Real>(type, [&](auto kernel) HWY_ATTR {                                                           \
      density_sums<typename decltype(kernel)::type, Dim, Real>(fields, lists, h, begin, end, sums);                    \
    });                                                                                                                \
  }
SMELT_INSTANTIATE(3, float, 3f)
SMELT_INSTANTIATE(3, double, 3d)
SMELT_INSTANTIATE(2, double, 2d)
SMELT_INSTANTIATE(1, double, 1d)
#undef SMELT_INSTANTIATE

}  // namespace HWY_NAMESPACE
}  // namespace smelt
HWY_AFTER_NAMESPACE();

#endif  // SMELT_PAIR_SUMS_INL_H
