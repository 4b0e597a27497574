#include "bench/pairs_bench.h"

#include "bench/best_seconds.h"
#include "core/sph/pair_sums.h"

#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace smelt {

namespace {

using Fields = PairFields<3, float>;

constexpr double smoothing_length = 1.3;  // spacings
constexpr double skin = 0.17;             // smoothing lengths: of particles that flow

// Additions, multiplications, comparisons, divisions and roots of one pair in the loops, the reduction at a row's end
// left out.
constexpr double rates_flops = 6 + 5 + 13 + 7 + 33 + 31 + 20;
constexpr double forces_flops = 6 + 5 + 13 + 15 + 27 + 40;
// The first cache line of a record, or both, and a place in a run.
constexpr double rates_bytes = 64 + 1, forces_bytes = 128 + 1;

struct Block {
  Fields fields;
  NeighbourLists lists;
  std::size_t n = 0;
  double n_pairs = 0.0;
};

Block make_jittered_block(std::size_t n_particles) {
  const int edge = std::max(4, static_cast<int>(std::lround(std::cbrt(static_cast<double>(n_particles)))));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.15, 0.15);
  std::vector<Vec3> position;
  for (int z = 0; z < edge; ++z)
    for (int y = 0; y < edge; ++y)
      for (int x = 0; x < edge; ++x)
        position.push_back(Vec3(x + jitter(random), y + jitter(random), z + jitter(random)));
  std::vector<std::int32_t> id(position.size());
  std::iota(id.begin(), id.end(), 0);
  const double reach = (2.0 + skin) * smoothing_length;
  Block block;
  block.n = position.size();
  std::vector<Vec3> sorted;
  for (const std::int32_t k : compute_cell_order<3>(position, id, reach))
    sorted.push_back(position[static_cast<std::size_t>(k)]);
  build_neighbour_lists<3>(sorted, reach, reach, pair_lanes<float>, block.lists);
  for (std::size_t i = 0; i < block.n; ++i) block.n_pairs += static_cast<double>(block.lists.row(i).size());
  block.fields.resize(block.n, true);
  for (float& value : block.fields.records) value = static_cast<float>(1.0 + jitter(random));
  for (std::size_t i = 0; i < block.n; ++i)
    for (int a = 0; a < 3; ++a) block.fields.record(i)[a] = static_cast<float>(sorted[i][a]);
  return block;
}

void time_passes(const Block& block, const std::string& instructions, std::vector<PassTiming>& passes) {
  PairTerms terms;
  terms.stress = terms.hourglass = terms.xsph = true;
  terms.heat = HeatTerms::uniform;
  std::vector<RateSums<3, float>> rates(block.n);
  std::vector<std::array<float, 3>> acceleration(block.n);
  constexpr int n_runs = 7;
  const double rates_seconds = best_seconds(n_runs, [&] {
    compute_rate_sums<3, float>(block.fields, block.lists, terms, smoothing_length, 0, block.n, rates.data());
  });
  const double forces_seconds = best_seconds(n_runs, [&] {
    compute_force_sums<3, float>(block.fields, block.lists, terms, {smoothing_length, 0.1, 10.0}, 0, block.n,
                                 acceleration.data());
  });
  passes.push_back({"rates", instructions, block.n, block.n_pairs / rates_seconds, rates_flops, rates_bytes});
  passes.push_back({"forces", instructions, block.n, block.n_pairs / forces_seconds, forces_flops, forces_bytes});
}

}  // namespace

PairsBench bench_pairs(std::size_t n_particles) {
  PairsBench bench;
  bench.peaks = measure_machine_peaks();
  const Block block = make_jittered_block(n_particles);
  const std::int64_t available = hwy::SupportedTargets();
  const std::pair<std::int64_t, const char*> sets[] = {{HWY_AVX2, "AVX2"}, {HWY_AVX3, "AVX-512"}};
  for (const auto& [target, name] : sets) {
    if ((available & target) == 0) continue;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().DeInit();
    time_passes(block, name, bench.passes);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
  return bench;
}

}  // namespace smelt
