#include "core/sph/neighbours.h"

#include "core/error.h"
#include "core/parallel.h"

#include <tbb/parallel_sort.h>

#include <array>
#include <cmath>
#include <numeric>

namespace smelt {

namespace {

constexpr int bits_per_axis = 21;
constexpr std::int64_t max_cells = std::int64_t{1} << bits_per_axis;

/// Integer coordinates of cells over the particles' bounding box, packed into one key, x in the low bits.
template <int Dim>
struct CellFrame {
  Vec<Dim> origin;
  double inverse_size;

  std::uint64_t key(const Vec<Dim>& x) const {
    std::uint64_t key = 0;
    for (int axis = Dim - 1; axis >= 0; --axis) {
      // One empty cell in front, so that the neighbours of cell 0 have keys too.
      const auto cell = static_cast<std::uint64_t>((x[axis] - origin[axis]) * inverse_size) + 1;
      key = (key << bits_per_axis) | cell;
    }
    return key;
  }
};

template <int Dim>
CellFrame<Dim> make_cell_frame(std::span<const Vec<Dim>> position, double cell_size) {
  const Box<Dim> bounds = deterministic_reduce(
      position.size(), Box<Dim>{},
      [&](std::size_t i) {
        Box<Dim> box;
        box.extend(position[i]);
        return box;
      },
      [](Box<Dim> a, const Box<Dim>& b) {
        a.lower = a.lower.cwiseMin(b.lower);
        a.upper = a.upper.cwiseMax(b.upper);
        return a;
      });
  const double cells = bounds.extent().maxCoeff() / cell_size;
  if (!(cells < static_cast<double>(max_cells - 3)))
    throw InternalError(fmt::format("neighbour search: the particles span {} cells of {} m", cells, cell_size));
  return {bounds.lower, 1.0 / cell_size};
}

/// Cells that hold particles, in the particles' order, found by key through an open-addressing table.
class CellTable {
 public:
  struct Cell {
    std::uint64_t key;
    std::int32_t begin;
    std::int32_t end;
  };

  explicit CellTable(const std::vector<std::uint64_t>& keys) {
    const auto n = static_cast<std::int32_t>(keys.size());
    for (std::int32_t i = 0; i < n; ++i) {
      if (cells_.empty() || cells_.back().key != keys[i]) cells_.push_back({keys[i], i, i});
      cells_.back().end = i + 1;
    }
    std::size_t capacity = 16;
    while (capacity < 2 * cells_.size()) capacity *= 2;
    mask_ = capacity - 1;
    slots_.assign(capacity, -1);
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      std::size_t slot = hash(cells_[c].key);
      while (slots_[slot] >= 0) slot = (slot + 1) & mask_;
      slots_[slot] = static_cast<std::int32_t>(c);
    }
  }

  const std::vector<Cell>& cells() const { return cells_; }

  const Cell* find(std::uint64_t key) const {
    for (std::size_t slot = hash(key); slots_[slot] >= 0; slot = (slot + 1) & mask_)
      if (cells_[slots_[slot]].key == key) return &cells_[slots_[slot]];
    return nullptr;
  }

 private:
  std::size_t hash(std::uint64_t key) const { return ((key * 0x9e3779b97f4a7c15ULL) >> 20) & mask_; }

  std::vector<Cell> cells_;
  std::vector<std::int32_t> slots_;
  std::size_t mask_ = 0;
};

/// Particle ranges of the 3^Dim cells around a cell, in key order.
template <int Dim>
int find_ranges(const CellTable& table, std::uint64_t key, std::array<CellTable::Cell, 27>& ranges) {
  constexpr int n_around = Dim == 1 ? 3 : Dim == 2 ? 9 : 27;
  int n = 0;
  for (int k = 0; k < n_around; ++k) {
    const std::uint64_t dx = k % 3, dy = Dim > 1 ? k / 3 % 3 : 1, dz = Dim > 2 ? k / 9 : 1;
    std::uint64_t around = key + dx - 1;
    if constexpr (Dim > 1) around += (dy - 1) << bits_per_axis;
    if constexpr (Dim > 2) around += (dz - 1) << (2 * bits_per_axis);
    if (const CellTable::Cell* cell = table.find(around)) ranges[n++] = *cell;
  }
  return n;
}

/// What cells are sorted by. In 3D, rods of 4 x 4 cells along x one after another: what the particles of a few cells have in reach then lies
/// in a core's own cache however many particles there are.
template <int Dim>
std::uint64_t rank_cell(std::uint64_t key) {
  if constexpr (Dim < 3) return key;
  constexpr int bits_in_rod = 2;
  constexpr std::uint64_t axis_mask = max_cells - 1, rod_mask = (1 << bits_in_rod) - 1;
  const std::uint64_t x = key & axis_mask, y = (key >> bits_per_axis) & axis_mask, z = key >> (2 * bits_per_axis);
  std::uint64_t rank = z >> bits_in_rod;
  rank = (rank << (bits_per_axis - bits_in_rod)) | (y >> bits_in_rod);
  rank = (rank << bits_per_axis) | x;
  rank = (rank << bits_in_rod) | (z & rod_mask);
  return (rank << bits_in_rod) | (y & rod_mask);
}

template <int Dim>
std::vector<std::uint64_t> compute_keys(std::span<const Vec<Dim>> position, double cell_size) {
  const CellFrame<Dim> frame = make_cell_frame<Dim>(position, cell_size);
  std::vector<std::uint64_t> keys(position.size());
  parallel_for_each(position.size(), [&](std::size_t i) { keys[i] = frame.key(position[i]); });
  return keys;
}

}  // namespace

template <int Dim>
std::vector<std::int32_t> compute_cell_order(std::span<const Vec<Dim>> position, std::span<const std::int32_t> id,
                                             double cell_size) {
  std::vector<std::uint64_t> ranks = compute_keys<Dim>(position, cell_size);
  for (std::uint64_t& rank : ranks) rank = rank_cell<Dim>(rank);
  std::vector<std::int32_t> order(position.size());
  std::iota(order.begin(), order.end(), 0);
  tbb::parallel_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return ranks[a] != ranks[b] ? ranks[a] < ranks[b] : id[a] < id[b];
  });
  return order;
}

template <int Dim>
void build_neighbour_lists(std::span<const Vec<Dim>> position, double radius, double cell_size, int row_multiple,
                           NeighbourLists& lists) {
  CHECK_GE(cell_size, radius);
  const std::size_t n = position.size();
  const CellTable table(compute_keys<Dim>(position, cell_size));
  const auto& cells = table.cells();
  const double radius2 = radius * radius;
  lists.row_multiple = row_multiple;
  lists.begin.resize(n);
  lists.count.resize(n);
  constexpr std::size_t cells_per_block = 32;
  lists.blocks.resize((cells.size() + cells_per_block - 1) / cells_per_block);
  parallel_blocks(
      lists.blocks.size(),
      [&](std::size_t block, std::size_t) {
        thread_local std::vector<std::int32_t> found;
        found.clear();
        const std::size_t end = std::min(cells.size(), (block + 1) * cells_per_block);
        std::array<CellTable::Cell, 27> ranges;
        for (std::size_t c = block * cells_per_block; c < end; ++c) {
          const int n_ranges = find_ranges<Dim>(table, cells[c].key, ranges);
          std::size_t n_candidates = 0;
          for (int k = 0; k < n_ranges; ++k) n_candidates += static_cast<std::size_t>(ranges[k].end - ranges[k].begin);
          for (std::int32_t i = cells[c].begin; i < cells[c].end; ++i) {
            const std::size_t start = found.size();
            found.resize(start + n_candidates + static_cast<std::size_t>(row_multiple));
            std::int32_t* out = found.data() + start;
            // Branch-free: every candidate is written, only near ones are kept.
            for (int k = 0; k < n_ranges; ++k) {
              for (std::int32_t j = ranges[k].begin; j < ranges[k].end; ++j) {
                *out = j;
                out += (position[i] - position[j]).squaredNorm() < radius2 && j != i;
              }
            }
            const auto count = static_cast<std::size_t>(out - (found.data() + start));
            std::fill(out, out + (lists.padded(count) - count), i);
            lists.count[i] = static_cast<std::int32_t>(count);
            found.resize(start + lists.padded(count));
          }
        }
        lists.blocks[block].assign(found.begin(), found.end());
        const std::int32_t* row = lists.blocks[block].data();
        for (std::int32_t i = cells[block * cells_per_block].begin; i < cells[end - 1].end; ++i) {
          lists.begin[i] = row;
          row += lists.padded(static_cast<std::size_t>(lists.count[i]));
        }
      },
      1);
}

template std::vector<std::int32_t> compute_cell_order<1>(std::span<const Vec<1>>, std::span<const std::int32_t>, double);
template std::vector<std::int32_t> compute_cell_order<2>(std::span<const Vec<2>>, std::span<const std::int32_t>, double);
template std::vector<std::int32_t> compute_cell_order<3>(std::span<const Vec<3>>, std::span<const std::int32_t>, double);
template void build_neighbour_lists<1>(std::span<const Vec<1>>, double, double, int, NeighbourLists&);
template void build_neighbour_lists<2>(std::span<const Vec<2>>, double, double, int, NeighbourLists&);
template void build_neighbour_lists<3>(std::span<const Vec<3>>, double, double, int, NeighbourLists&);

}  // namespace smelt
