#include "surfacing/sparse_field.h"

#include "core/error.h"
#include "core/parallel.h"
#include "surfacing/kernel.h"
#include "surfacing/key_lists.h"

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

constexpr int edge = SparseField::block_edge;

/// Bytes that the surface of a stored block costs from chi to the smoothed mesh, at the worst moment: 10.6 to 11.4 kB
/// on bodies and sprays of 10^4 to 10^6 particles, where a block has 30 to 40 vertices with their faces, neighbours,
/// displacements and fields. Its own samples are 2 kB of that.
constexpr double bytes_per_block = 11.5e3;

struct BlockRange {
  Lattice low{}, high{-1, -1, -1};
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
      "surfacing: a grid with cells of {:.3g} m around these particles and its mesh would need about {:.3g} GB, "
      "allowed are {:.3g} GB; take coarser cells (surface.cell_over_spacing) or fewer particles, or free memory",
      cell, bytes * 1e-9, limit * 1e-9);
}

Vec3 first_sample(std::uint64_t block_key, double cell) {
  const Lattice at = lattice_from_key(block_key);
  return cell * edge * Vec3(at[0], at[1], at[2]);
}

/// The samples of a block and of the layers next to it that its cells, or those of its neighbours, share with it.
Box3 box_of(std::uint64_t block_key, double cell) {
  const Vec3 first = first_sample(block_key, cell);
  return {first.array() - cell, first.array() + edge * cell};
}

template <typename Visit>
void for_each_neighbour(std::uint64_t block_key, Visit&& visit) {
  const Lattice p = lattice_from_key(block_key);
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x)
        if (x != 0 || y != 0 || z != 0) visit(Lattice{x, y, z}, lattice_key(p[0] + x, p[1] + y, p[2] + z));
}

/// The keys that keep(key) says yes to, in their order.
template <typename Keep>
std::vector<std::uint64_t> select(const std::vector<std::uint64_t>& keys, Keep&& keep) {
  std::vector<std::uint8_t> kept(keys.size());
  parallel_blocks(
      keys.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) kept[i] = keep(keys[i]);
      },
      64);
  std::vector<std::uint64_t> out;
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (kept[i] != 0) out.push_back(keys[i]);
  return out;
}

/// Absent neighbours of `blocks` that lie inside.
std::vector<std::uint64_t> find_deep(const SparseField& field, const std::vector<std::uint64_t>& blocks,
                                     const SurfaceRegion& region) {
  const std::vector<std::uint64_t> absent =
      collect_keys(blocks.size(), [&](std::size_t b, std::vector<std::uint64_t>& keys) {
        for_each_neighbour(blocks[b], [&](const Lattice&, std::uint64_t key) {
          if (field.find(key) == SparseField::no_block) keys.push_back(key);
        });
      });
  return select(absent, [&](std::uint64_t key) { return !region.touches_surface(box_of(key, field.cell)); });
}

/// Adds weight W(q) for all samples of a block; q^2 = d^T M d, d [cells] from `centre`, which is relative to sample 0.
void accumulate_particle(float* sample, const Vec3f& centre, const std::array<float, 6>& m,
                         const std::array<float, 3>& reach, float weight) {
  static_assert(edge == 8, "a row of samples is one register");
  const Float8 dx = Float8{0, 1, 2, 3, 4, 5, 6, 7} - centre[0];
  const Float8 dx_squared = m[0] * dx * dx;
  const int k_low = std::max(0, static_cast<int>(std::ceil(centre[2] - reach[2])));
  const int k_high = std::min(edge - 1, static_cast<int>(std::floor(centre[2] + reach[2])));
  const int j_low = std::max(0, static_cast<int>(std::ceil(centre[1] - reach[1])));
  const int j_high = std::min(edge - 1, static_cast<int>(std::floor(centre[1] + reach[1])));
  const float four_m = 4.0f * m[0];
  for (int k = k_low; k <= k_high; ++k)
    for (int j = j_low; j <= j_high; ++j) {
      const float dz = static_cast<float>(k) - centre[2], dy = static_cast<float>(j) - centre[1];
      const float linear = 2.0f * (m[3] * dy + m[4] * dz),
                  rest = m[1] * dy * dy + m[2] * dz * dz + 2.0f * m[5] * dy * dz;
      // The least q^2 of the row is rest - linear^2/(4 M_xx).
      if (four_m * (rest - 4.0f) >= linear * linear) continue;
      const Float8 q_squared = dx_squared + (linear * dx + rest);
      float* row = sample + edge * (j + edge * k);
      store8(row, load8(row) + weight * cubic_spline(sqrt(positive_part(q_squared))));
    }
}

/// The particles of one bin, into a block whose first sample is at `first`.
void accumulate_bin(float* sample, const ChiSource& source, const KernelShape& plain, std::size_t bin,
                    const Vec3& first, double cell) {
  const ParticleBins& bins = source.bins;
  const Vec3f corner = ((bins.origin(bin) - first) / cell).cast<float>();
  const auto cells_per_edge = static_cast<float>(bins.edge / cell), per_metre = static_cast<float>(1.0 / cell);
  const float per_metre_squared = per_metre * per_metre;
  const bool shaped = source.shapes != nullptr && source.shapes->first[bin] != KernelShapes::isotropic;
  KernelShape s = plain;
  const auto to_cells = [&] {
    for (float& m : s.m) m /= per_metre_squared;
    for (float& r : s.reach) r *= per_metre;
  };
  to_cells();
  for (std::uint32_t j = bins.begin[bin]; j < bins.begin[bin + 1]; ++j) {
    if (shaped) {
      s = source.shapes->shape[source.shapes->first[bin] + j - bins.begin[bin]];
      to_cells();
    }
    Vec3f centre;
    bool reaches = true;
    for (int a = 0; a < 3; ++a) {
      centre[a] = corner[a] + cells_per_edge * bins.offset[a][j];
      reaches = reaches && centre[a] > -s.reach[a] && centre[a] < static_cast<float>(edge - 1) + s.reach[a];
    }
    if (reaches) accumulate_particle(sample, centre, s.m, s.reach, s.weight * source.volume[j]);
  }
}

/// The farthest that any kernel reaches from the bin of its particle [m].
double farthest_reach(const ChiSource& source) {
  double reach = 2.0 * source.h;
  if (source.shapes)
    for (const KernelShape& s : source.shapes->shape)
      for (int a = 0; a < 3; ++a) reach = std::max(reach, static_cast<double>(s.reach[a]));
  return reach;
}

void compute_blocks(SparseField& field, const ChiSource& source, const std::vector<std::uint64_t>& blocks) {
  const double reach = farthest_reach(source);
  const KernelShape plain = isotropic_shape(source.h);
  parallel_blocks(
      blocks.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
          const Vec3 first = first_sample(blocks[b], field.cell);
          alignas(32) float sample[SparseField::block_size] = {};
          for_each_bin(source.bins, first.array() - reach, first.array() + (field.cell * (edge - 1) + reach),
                       [&](std::size_t bin) { accumulate_bin(sample, source, plain, bin, first, field.cell); });
          std::copy(std::begin(sample), std::end(sample),
                    field.value.begin() + field.find(blocks[b]) * SparseField::block_size);
        }
      },
      1);
}

/// Whether a sample of the block on its side towards a neighbour is below `iso`.
bool is_open_towards(const SparseField& field, std::size_t block, const Lattice& way, float iso) {
  Lattice low{}, high{edge - 1, edge - 1, edge - 1};
  for (int a = 0; a < 3; ++a) {
    if (way[a] < 0) high[a] = 0;
    if (way[a] > 0) low[a] = edge - 1;
  }
  const float* value = &field.value[block * SparseField::block_size];
  for (int k = low[2]; k <= high[2]; ++k)
    for (int j = low[1]; j <= high[1]; ++j)
      for (int i = low[0]; i <= high[0]; ++i)
        if (value[i + edge * (j + edge * k)] < iso) return true;
  return false;
}

std::vector<std::uint64_t> find_open_deep(const SparseField& field, float iso) {
  return select(field.deep, [&](std::uint64_t deep) {
    bool open = false;
    for_each_neighbour(deep, [&](const Lattice& way, std::uint64_t key) {
      const std::size_t block = open ? SparseField::no_block : field.find(key);
      open =
          open || (block != SparseField::no_block && is_open_towards(field, block, {-way[0], -way[1], -way[2]}, iso));
    });
    return open;
  });
}

void check_memory(double n_blocks, double cell, double limit) {
  if (n_blocks * bytes_per_block > limit) fail_on_memory(n_blocks * bytes_per_block, cell, limit);
}

/// Takes more blocks into the field, its values kept.
void add_blocks(SparseField& field, const std::vector<std::uint64_t>& blocks) {
  SparseField old = std::move(field);
  field.cell = old.cell;
  std::merge(old.key.begin(), old.key.end(), blocks.begin(), blocks.end(), std::back_inserter(field.key));
  std::set_difference(old.deep.begin(), old.deep.end(), blocks.begin(), blocks.end(), std::back_inserter(field.deep));
  field.value.resize(field.n_blocks() * SparseField::block_size);
  for (std::size_t b = 0, at = 0; b < old.n_blocks(); ++b) {
    while (field.key[at] != old.key[b]) ++at;
    std::copy_n(old.value.begin() + b * SparseField::block_size, SparseField::block_size,
                field.value.begin() + at * SparseField::block_size);
  }
}

}  // namespace

std::size_t SparseField::find(std::uint64_t block_key) const {
  const auto at = std::lower_bound(key.begin(), key.end(), block_key);
  return at != key.end() && *at == block_key ? static_cast<std::size_t>(at - key.begin()) : no_block;
}

float SparseField::absent_value(std::uint64_t block_key) const {
  return std::binary_search(deep.begin(), deep.end(), block_key) ? 1.0f : 0.0f;
}

float SparseField::sample(int i, int j, int k) const {
  const std::uint64_t block_key = lattice_key(i >> 3, j >> 3, k >> 3);
  const std::size_t block = find(block_key);
  return block == no_block ? absent_value(block_key)
                           : value[block * block_size + ((k & 7) * edge + (j & 7)) * edge + (i & 7)];
}

SparseField allocate_field(const ParticleBins& bins, double radius, double cell, double memory_limit,
                           const SurfaceRegion* region) {
  // How many blocks the bins name between them, most of them several times: known before anything is allocated.
  const std::size_t n_bins = bins.n_bins();
  std::vector<BlockRange> ranges(n_bins);
  parallel_for_each(n_bins, [&](std::size_t b) {
    const Box3 box = bins.box(b);
    // As far as any block goes that the bin reaches.
    const double far = radius + (edge + 1) * cell;
    const Box3 around{box.lower.array() - far, box.upper.array() + far};
    if (!region || region->touches_surface(around)) ranges[b] = blocks_of(box, radius, cell);
  });
  std::vector<std::size_t> first(n_bins + 1, 0);
  double n_named = 0.0;
  for (std::size_t b = 0; b < n_bins; ++b) {
    n_named += ranges[b].count();
    if (n_named * sizeof(std::uint64_t) > memory_limit)
      fail_on_memory(n_named / 27.0 * bytes_per_block * static_cast<double>(n_bins) / static_cast<double>(b + 1), cell,
                     memory_limit);
    first[b + 1] = static_cast<std::size_t>(n_named);
  }

  // List them, keep each once, and of these what touches the surface.
  SparseField field;
  field.cell = cell;
  field.key.resize(first[n_bins]);
  parallel_for_each(n_bins, [&](std::size_t b) {
    std::size_t at = first[b];
    for (int z = ranges[b].low[2]; z <= ranges[b].high[2]; ++z)
      for (int y = ranges[b].low[1]; y <= ranges[b].high[1]; ++y)
        for (int x = ranges[b].low[0]; x <= ranges[b].high[0]; ++x) field.key[at++] = lattice_key(x, y, z);
  });
  sort_unique(field.key);
  if (region)
    field.key = select(field.key, [&](std::uint64_t key) { return region->touches_surface(box_of(key, cell)); });
  check_memory(static_cast<double>(field.n_blocks()), cell, memory_limit);
  if (region) field.deep = find_deep(field, field.key, *region);
  return field;
}

SparseField compute_chi(const ChiSource& source, double cell, float iso, double memory_limit,
                        const SurfaceRegion* region) {
  CHECK_EQ(source.volume.size(), source.bins.n_particles());
  SparseField field = allocate_field(source.bins, farthest_reach(source), cell, memory_limit, region);
  field.value.resize(field.n_blocks() * SparseField::block_size);
  compute_blocks(field, source, field.key);
  if (!region) return field;
  for (;;) {
    const std::vector<std::uint64_t> open = find_open_deep(field, iso);
    if (open.empty()) return field;
    add_blocks(field, open);
    check_memory(static_cast<double>(field.n_blocks()), cell, memory_limit);
    compute_blocks(field, source, open);
    const std::vector<std::uint64_t> deep = find_deep(field, open, *region);
    field.deep.insert(field.deep.end(), deep.begin(), deep.end());
    sort_unique(field.deep);
  }
}

}  // namespace smelt
