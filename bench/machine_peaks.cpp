#include "bench/machine_peaks.h"

#include "bench/best_seconds.h"

// As core/sph/pair_sums.cpp.
#define HWY_BASELINE_TARGETS HWY_AVX2
#define HWY_DISABLED_TARGETS HWY_AVX3_DL
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/machine_peaks.cpp"
// clang-format off
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <cstddef>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace smelt {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::CappedTag<float, 16>;

/// Chains of multiply-adds, enough of them to hide their latency. Returns what the compiler may not leave out.
inline float multiply_add(std::size_t n_rounds) {
  const Lanes d;
  constexpr int n_chains = 12;
  hn::Vec<Lanes> chain[n_chains];
  for (int c = 0; c < n_chains; ++c) chain[c] = hn::Set(d, static_cast<float>(c));
  const auto factor = hn::Set(d, 0.999f), term = hn::Set(d, 0.001f);
  for (std::size_t k = 0; k < n_rounds; ++k)
    for (auto& value : chain) value = hn::MulAdd(value, factor, term);
  auto sum = chain[0];
  for (int c = 1; c < n_chains; ++c) sum = hn::Add(sum, chain[c]);
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

inline double flops_a_round() {
  return 2.0 * 12.0 * static_cast<double>(hn::Lanes(Lanes()));
}

/// The sum of `n` numbers, a multiple of 128.
inline float sum_all(const float* values, std::size_t n) {
  const Lanes d;
  constexpr int n_sums = 8;
  const std::size_t lanes = hn::Lanes(d);
  hn::Vec<Lanes> sums[n_sums];
  for (auto& sum : sums) sum = hn::Zero(d);
  for (std::size_t k = 0; k < n; k += n_sums * lanes)
    for (int s = 0; s < n_sums; ++s)
      sums[s] = hn::Add(sums[s], hn::LoadU(d, values + k + static_cast<std::size_t>(s) * lanes));
  for (int s = 1; s < n_sums; ++s) sums[0] = hn::Add(sums[0], sums[s]);
  return hn::GetLane(hn::SumOfLanes(d, sums[0]));
}

}  // namespace HWY_NAMESPACE
}  // namespace smelt
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace smelt {

HWY_EXPORT(multiply_add);
HWY_EXPORT(flops_a_round);
HWY_EXPORT(sum_all);

namespace {

volatile float kept = 0.0f;
constexpr int n_runs = 5;

double read_bytes_per_second(std::size_t n_bytes) {
  const std::vector<float> values(n_bytes / sizeof(float), 1.0f);
  const std::size_t n_passes = std::max<std::size_t>(1, (std::size_t{1} << 28) / n_bytes);
  const double seconds = best_seconds(n_runs, [&] {
    float sum = 0.0f;
    for (std::size_t pass = 0; pass < n_passes; ++pass)
      sum += HWY_DYNAMIC_DISPATCH(sum_all)(values.data(), values.size());
    kept = kept + sum;
  });
  return static_cast<double>(n_passes * n_bytes) / seconds;
}

}  // namespace

MachinePeaks measure_machine_peaks() {
  MachinePeaks peaks;
  constexpr std::size_t n_rounds = 4'000'000;
  peaks.flops = HWY_DYNAMIC_DISPATCH(flops_a_round)() * n_rounds /
                best_seconds(n_runs, [] { kept = kept + HWY_DYNAMIC_DISPATCH(multiply_add)(n_rounds); });
  peaks.l1_bytes = read_bytes_per_second(std::size_t{24} << 10);
  peaks.l2_bytes = read_bytes_per_second(std::size_t{384} << 10);
  peaks.l3_bytes = read_bytes_per_second(std::size_t{6} << 20);
  peaks.memory_bytes = read_bytes_per_second(std::size_t{256} << 20);
  return peaks;
}

}  // namespace smelt
#endif
