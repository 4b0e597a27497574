#include "surfacing/sparse_field.h"

#include "core/error.h"
#include "surfacing/kernel.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

constexpr int edge = SparseField::block_edge;

/// Bytes a stored block costs: its samples, its key, and what marching cubes keeps for it
/// (surfacing/marching_cubes.cpp).
constexpr double bytes_per_block = 512.0 * 4.0 + 8.0 + 1536.0 * 2.0;

struct BlockRange {
  Lattice low, high;
  double count() const { return (high[0] - low[0] + 1.0) * (high[1] - low[1] + 1.0) * (high[2] - low[2] + 1.0); }
};

/// Blocks that hold the samples within `radius` of a box, and the samples one step below.
BlockRange blocks_of(const Box3& box, double radius, double cell) {
  BlockRange range;
  for (int a = 0; a < 3; ++a) {
    const double low = std::floor((std::ceil((box.lower[a] - radius) / cell) - 1.0) / edge);
    const double high = std::floor(std::floor((box.upper[a] + radius) / cell) / edge);
    if (low <= -lattice_limit || high >= lattice_limit)
      fail(
          "surfacing: particles reach {} m from the origin, which is more than {:.3g} m, the most a grid with cells of "
          "{:.3g} m can address; move the scene to the origin or take coarser cells",
          std::max(std::abs(box.lower[a]), std::abs(box.upper[a])), cell * edge * lattice_limit, cell);
    range.low[a] = static_cast<int>(low);
    range.high[a] = static_cast<int>(high);
  }
  return range;
}

[[noreturn]] void fail_on_memory(double bytes, double cell, double limit) {
  fail(
      "surfacing: a grid with cells of {:.3g} m around these particles would need about {:.3g} GB, allowed are {:.3g} "
      "GB; "
      "take coarser cells or raise the limit",
      cell, bytes * 1e-9, limit * 1e-9);
}

/// Adds volume * W(x - x_j) for all samples of a block. `centre` is x_j relative to sample 0, in cells, like `radius` =
/// 2 h.
void accumulate_particle(float* sample, const Vec3f& centre, float radius, float scaled_volume) {
  static_assert(edge == 8, "a row of samples is one register");
  const float q_per_cell = 2.0f / radius;
  const Float8 dx = Float8{0, 1, 2, 3, 4, 5, 6, 7} - centre[0];
  const Float8 dx_squared = dx * dx;
  const int k_low = std::max(0, static_cast<int>(std::ceil(centre[2] - radius)));
  const int k_high = std::min(edge - 1, static_cast<int>(std::floor(centre[2] + radius)));
  const int j_low = std::max(0, static_cast<int>(std::ceil(centre[1] - radius)));
  const int j_high = std::min(edge - 1, static_cast<int>(std::floor(centre[1] + radius)));
  for (int k = k_low; k <= k_high; ++k)
    for (int j = j_low; j <= j_high; ++j) {
      const float dz = static_cast<float>(k) - centre[2], dy = static_cast<float>(j) - centre[1];
      const float rest = dz * dz + dy * dy;
      if (rest >= radius * radius) continue;
      float* row = sample + edge * (j + edge * k);
      store8(row, load8(row) + scaled_volume * cubic_spline(q_per_cell * sqrt(dx_squared + rest)));
    }
}

}  // namespace

std::size_t SparseField::find(std::uint64_t block_key) const {
  const auto at = std::lower_bound(key.begin(), key.end(), block_key);
  return at != key.end() && *at == block_key ? static_cast<std::size_t>(at - key.begin()) : no_block;
}

float SparseField::sample(int i, int j, int k) const {
  const std::size_t block = find(lattice_key(i >> 3, j >> 3, k >> 3));
  return block == no_block ? 0.0f : value[block * block_size + ((k & 7) * edge + (j & 7)) * edge + (i & 7)];
}

SparseField allocate_field(const ParticleBins& bins, double radius, double cell, double memory_limit) {
  // How many blocks the bins name between them, most of them several times: known before anything is allocated.
  const std::size_t n_bins = bins.n_bins();
  std::vector<BlockRange> ranges(n_bins);
  std::vector<std::size_t> first(n_bins + 1, 0);
  double n_named = 0.0;
  for (std::size_t b = 0; b < n_bins; ++b) {
    Box3 box;
    for (std::uint32_t i = bins.begin[b]; i < bins.begin[b + 1]; ++i) box.extend(bins.position[i]);
    ranges[b] = blocks_of(box, radius, cell);
    n_named += ranges[b].count();
    if (n_named * sizeof(std::uint64_t) > memory_limit)
      fail_on_memory(n_named / 27.0 * bytes_per_block * static_cast<double>(n_bins) / static_cast<double>(b + 1), cell,
                     memory_limit);
    first[b + 1] = static_cast<std::size_t>(n_named);
  }

  // List them, then keep each once.
  SparseField field;
  field.cell = cell;
  field.key.resize(first[n_bins]);
  tbb::parallel_for(std::size_t{0}, n_bins, [&](std::size_t b) {
    std::size_t at = first[b];
    for (int z = ranges[b].low[2]; z <= ranges[b].high[2]; ++z)
      for (int y = ranges[b].low[1]; y <= ranges[b].high[1]; ++y)
        for (int x = ranges[b].low[0]; x <= ranges[b].high[0]; ++x) field.key[at++] = lattice_key(x, y, z);
  });
  tbb::parallel_sort(field.key);
  field.key.erase(std::unique(field.key.begin(), field.key.end()), field.key.end());

  const double bytes = static_cast<double>(field.n_blocks()) * bytes_per_block;
  if (bytes > memory_limit) fail_on_memory(bytes, cell, memory_limit);
  field.value.resize(field.n_blocks() * SparseField::block_size);
  return field;
}

void compute_chi(SparseField& field, const ParticleBins& bins, std::span<const float> volume, double h) {
  CHECK_EQ(volume.size(), bins.position.size());
  const double radius = 2.0 * h;
  const auto scale = static_cast<float>(1.0 / (h * h * h));
  tbb::parallel_for(std::size_t{0}, field.n_blocks(), [&](std::size_t block) {
    const Lattice at = lattice_from_key(field.key[block]);
    const Vec3 first = field.cell * edge * Vec3(at[0], at[1], at[2]);
    const Vec3 lower = first.array() - radius, upper = first.array() + (field.cell * (edge - 1) + radius);
    alignas(32) float sample[SparseField::block_size] = {};
    for_each_range(bins, lower, upper, [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t j = begin; j < end; ++j) {
        const Vec3& x = bins.position[j];
        if ((x.array() <= lower.array()).any() || (x.array() >= upper.array()).any()) continue;
        accumulate_particle(sample, ((x - first) / field.cell).cast<float>(), static_cast<float>(radius / field.cell),
                            scale * volume[j]);
      }
    });
    std::copy(std::begin(sample), std::end(sample), field.value.begin() + block * SparseField::block_size);
  });
}

}  // namespace smelt
