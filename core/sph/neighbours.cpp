#include "core/sph/neighbours.h"

#include "core/error.h"
#include "core/parallel.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <immintrin.h>
#include <limits>
#include <numeric>
#include <utility>

namespace smelt {

namespace {

/// Of a distance's square, by what rounds it off.
constexpr double search_excess = 2e-6;

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
  const Box<Dim> bounds = bounds_of<Dim>(position);
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

  template <int Dim>
  CellTable(std::span<const Vec<Dim>> position, const CellFrame<Dim>& frame) {
    const auto n = static_cast<std::int32_t>(position.size());
    for (std::int32_t i = 0; i < n; ++i) {
      const std::uint64_t key = frame.key(position[i]);
      if (cells_.empty() || cells_.back().key != key) cells_.push_back({key, i, i});
      cells_.back().end = i + 1;
    }
    std::size_t capacity = 16;
    while (capacity < 2 * cells_.size()) capacity *= 2;
    mask_ = capacity - 1;
    shift_ = 64 - std::countr_zero(capacity);
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
  /// The highest bits of a product are those that every bit of the key takes part in.
  std::size_t hash(std::uint64_t key) const { return (key * 0x9e3779b97f4a7c15ULL) >> shift_; }

  std::vector<Cell> cells_;
  std::vector<std::int32_t> slots_;
  std::size_t mask_ = 0;
  int shift_ = 0;
};

/// Particles [begin, end) that lie next to one another.
struct Piece {
  std::int32_t begin, end;
};

/// What the particles of a cell may have in reach: pieces in order, and the runs that they lie in. A run spans no more
/// than a byte can say, gaps included.
struct Surroundings {
  std::vector<Piece> cells;
  std::vector<Piece> pieces;
  std::vector<std::int32_t> run_begin;      ///< the first particle of each run
  std::vector<std::size_t> first_piece{0};  ///< of each run, and where the last ends

  void clear() {
    pieces.clear();
    run_begin.clear();
    first_piece.assign(1, 0);
  }
  std::size_t n_runs() const { return run_begin.size(); }
};

/// The particles of the 3^Dim cells around a cell.
template <int Dim>
void find_surroundings(const CellTable& table, std::uint64_t key, Surroundings& out) {
  constexpr int n_around = Dim == 1 ? 3 : Dim == 2 ? 9 : 27;
  std::vector<Piece>& cells = out.cells;
  cells.clear();
  for (int k = 0; k < n_around; ++k) {
    const std::uint64_t dx = k % 3, dy = Dim > 1 ? k / 3 % 3 : 1, dz = Dim > 2 ? k / 9 : 1;
    std::uint64_t around = key + dx - 1;
    if constexpr (Dim > 1) around += (dy - 1) << bits_per_axis;
    if constexpr (Dim > 2) around += (dz - 1) << (2 * bits_per_axis);
    if (const CellTable::Cell* cell = table.find(around)) cells.push_back({cell->begin, cell->end});
  }
  std::sort(cells.begin(), cells.end(), [](const Piece& a, const Piece& b) { return a.begin < b.begin; });
  out.clear();
  for (const Piece& cell : cells)
    for (std::int32_t begin = cell.begin; begin < cell.end;) {
      const std::int32_t end = std::min(cell.end, begin + NeighbourLists::max_run);
      const bool starts_run = out.run_begin.empty() || end - out.run_begin.back() > NeighbourLists::max_run;
      if (starts_run) {
        out.run_begin.push_back(begin);
        out.first_piece.push_back(0);
      }
      if (!starts_run && out.pieces.back().end == begin)
        out.pieces.back().end = end;
      else
        out.pieces.push_back({begin, end});
      out.first_piece.back() = out.pieces.size();
      begin = end;
    }
}

/// What cells are sorted by. In 3D, rods of 8 x 4 cells along x one after another: what the particles of a few cells
/// have in reach then lies in a core's own cache however many particles there are, in half a dozen runs.
constexpr int rod_y_bits = 3, rod_z_bits = 2;
template <int Dim>
std::uint64_t rank_cell(std::uint64_t key) {
  if constexpr (Dim < 3) return key;
  constexpr int y_bits = rod_y_bits, z_bits = rod_z_bits;
  constexpr std::uint64_t axis_mask = max_cells - 1, y_mask = (1 << y_bits) - 1, z_mask = (1 << z_bits) - 1;
  const std::uint64_t x = key & axis_mask, y = (key >> bits_per_axis) & axis_mask, z = key >> (2 * bits_per_axis);
  std::uint64_t rank = z >> z_bits;
  rank = (rank << (bits_per_axis - y_bits)) | (y >> y_bits);
  rank = (rank << bits_per_axis) | x;
  rank = (rank << z_bits) | (z & z_mask);
  return (rank << y_bits) | (y & y_mask);
}

/// Sets `target` to `source`. Half as much again is set aside for what rows may grow to: memory that is not written
/// takes none, but blocks that all move to a little more leave holes too small for any other. It is given back once the
/// block needs three quarters of what it did.
template <typename T>
void replace(std::vector<T>& target, std::span<const T> source) {
  if (source.size() > target.capacity() || 2 * source.size() < target.capacity()) {
    target = std::vector<T>();
    target.reserve(source.size() + source.size() / 2);
  }
  target.assign(source.begin(), source.end());
}

/// What the particles of one cell may have in reach: positions piece by piece, each padded to whole vectors with what
/// nothing reaches. In single precision, in units of the radius, from the first of the cell's own particles.
template <int Dim>
struct Candidates {
  static constexpr std::size_t width = 8;  ///< of a vector: their places are compressed as one number
  static constexpr float nowhere = std::numeric_limits<float>::infinity();

  Vec<Dim> origin;
  double inverse_radius = 1.0;
  std::array<std::vector<float>, Dim> x;
  std::vector<std::uint64_t> places;      ///< of a vector in their run, a byte each; beyond the piece's end anything
  std::vector<std::size_t> first_vector;  ///< of each piece, and where the last ends

  float coordinate(const Vec<Dim>& position, int axis) const {
    return static_cast<float>((position[axis] - origin[axis]) * inverse_radius);
  }

  void gather(std::span<const Vec<Dim>> position, const Vec<Dim>& from, double radius, const Surroundings& around) {
    constexpr std::uint64_t first_places = 0x0706050403020100, ones = 0x0101010101010101;
    origin = from;
    inverse_radius = 1.0 / radius;
    places.clear();
    first_vector.clear();
    for (std::size_t r = 0; r < around.n_runs(); ++r)
      for (std::size_t p = around.first_piece[r]; p < around.first_piece[r + 1]; ++p) {
        const Piece& piece = around.pieces[p];
        first_vector.push_back(places.size());
        for (std::int32_t j = piece.begin; j < piece.end; j += static_cast<std::int32_t>(width))
          places.push_back(first_places + static_cast<std::uint64_t>(j - around.run_begin[r]) * ones);
      }
    first_vector.push_back(places.size());
    for (auto& coordinates : x) coordinates.resize(std::max(coordinates.size(), width * places.size()));
    for (std::size_t p = 0; p < around.pieces.size(); ++p) {
      std::size_t at = width * first_vector[p];
      for (std::int32_t j = around.pieces[p].begin; j < around.pieces[p].end; ++j, ++at)
#pragma GCC unroll 3
        for (int axis = 0; axis < Dim; ++axis) x[axis][at] = coordinate(position[j], axis);
      for (; at < width * first_vector[p + 1]; ++at) x[0][at] = nowhere;
    }
  }
};

/// Bit k says whether the k-th of Candidates::width points from `x` on lies nearer than sqrt(radius2) to `from`.
template <int Dim>
std::uint64_t within(const std::array<const float*, Dim>& x, std::size_t first, const __m256 (&from)[Dim],
                     __m256 radius2) {
  __m256 r2 = _mm256_setzero_ps();
#pragma GCC unroll 3
  for (int axis = 0; axis < Dim; ++axis) {
    const __m256 d = _mm256_sub_ps(_mm256_loadu_ps(x[axis] + first), from[axis]);
    r2 = _mm256_add_ps(_mm256_mul_ps(d, d), r2);
  }
  return static_cast<std::uint64_t>(_mm256_movemask_ps(_mm256_cmp_ps(r2, radius2, _CMP_LT_OQ)));
}

/// Rows one after another, with room for more.
class RowBytes {
 public:
  void clear() { size_ = 0; }
  std::span<const std::uint8_t> written() const { return {bytes_.data(), size_}; }
  std::size_t size() const { return size_; }
  /// Where up to `n` bytes may be written.
  std::uint8_t* make_room(std::size_t n) {
    if (bytes_.size() < size_ + n) bytes_.resize(2 * (size_ + n));
    return bytes_.data() + size_;
  }
  /// Takes in those of them that precede `end`.
  void end_at(const std::uint8_t* end) { size_ = static_cast<std::size_t>(end - bytes_.data()); }

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t size_ = 0;
};

/// Appends the row of particle `i` to `bytes`; returns how many neighbours it has.
template <int Dim>
std::size_t append_row(Candidates<Dim>& candidates, const Vec<Dim>& position, float radius2, const Surroundings& around,
                       std::int32_t i, RowBytes& bytes) {
  constexpr std::size_t width = Candidates<Dim>::width;
  constexpr std::uint64_t ones = 0x0101010101010101;
  const std::size_t n_vectors = candidates.places.size();
  thread_local std::vector<std::uint8_t*> end_of;  // what each vector wrote
  end_of.resize(n_vectors);
  std::uint8_t* const counts = bytes.make_room(around.n_runs() + width * (n_vectors + 1));
  std::uint8_t* const first = counts + around.n_runs();
  std::uint8_t* place = first;
  const __m256 radius2s = _mm256_set1_ps(radius2);
  std::array<const float*, Dim> x;
  __m256 from[Dim];
  for (int axis = 0; axis < Dim; ++axis) {
    x[axis] = candidates.x[axis].data();
    from[axis] = _mm256_set1_ps(candidates.coordinate(position, axis));
  }
  // Out of its own reach for a while.
  std::size_t own_piece = 0;
  while (i >= around.pieces[own_piece].end) ++own_piece;
  float& own_x = candidates.x[0][width * candidates.first_vector[own_piece] +
                                 static_cast<std::size_t>(i - around.pieces[own_piece].begin)];
  const float kept_x = std::exchange(own_x, Candidates<Dim>::nowhere);
  // All pieces in one loop: where one of them ends could not be foretold.
  const std::uint64_t* const places = candidates.places.data();
  std::uint8_t** const ends = end_of.data();
  for (std::size_t v = 0; v < n_vectors; ++v) {
    const std::uint64_t near = within<Dim>(x, width * v, from, radius2s);
    // A whole vector of places is written, the near ones in front.
    const std::uint64_t near_places = _pext_u64(places[v], _pdep_u64(near, ones) * 0xFF);
    std::memcpy(place, &near_places, width);
    ends[v] = place += std::popcount(near);
  }
  own_x = kept_x;
  const std::uint8_t* before = first;
  for (std::size_t r = 0; r < around.n_runs(); ++r) {
    const std::uint8_t* const end = ends[candidates.first_vector[around.first_piece[r + 1]] - 1];
    counts[r] = static_cast<std::uint8_t>(end - before);
    before = end;
  }
  bytes.end_at(place);
  return static_cast<std::size_t>(place - first);
}

}  // namespace

template <int Dim>
Box<Dim> bounds_of(std::span<const Vec<Dim>> position) {
  return deterministic_reduce(
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
}

template <int Dim>
std::pmr::vector<std::int32_t> compute_cell_order(std::span<const Vec<Dim>> position, std::span<const std::int32_t> id,
                                                  double cell_size, std::pmr::memory_resource* memory) {
  const CellFrame<Dim> frame = make_cell_frame<Dim>(position, cell_size);
  std::pmr::vector<std::uint64_t> ranks(position.size(), memory);
  parallel_for_each(position.size(), [&](std::size_t i) { ranks[i] = rank_cell<Dim>(frame.key(position[i])); });
  std::pmr::vector<std::int32_t> order(position.size(), memory);
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
  CHECK(std::has_single_bit(static_cast<unsigned>(row_multiple)) &&
        static_cast<std::size_t>(row_multiple) <= NeighbourLists::max_multiple);
  const CellTable table(position, make_cell_frame<Dim>(position, cell_size));
  // In radii. No coordinate of up to two cells is rounded by more: what lies within the radius must not be lost.
  const auto radius2 = static_cast<float>(1.0 + search_excess * cell_size / radius);
  const auto& cells = table.cells();
  constexpr std::size_t cells_per_block = NeighbourLists::cells_per_block;
  lists.row_multiple = row_multiple;
  lists.names.clear();
  lists.places.resize(position.size());
  lists.blocks.resize((cells.size() + cells_per_block - 1) / cells_per_block);
  std::vector<std::size_t> longest(lists.blocks.size(), 0);
  parallel_blocks(
      lists.blocks.size(),
      [&](std::size_t b, std::size_t) {
        NeighbourLists::Block& block = lists.blocks[b];
        thread_local std::vector<std::int32_t> run_begin;
        thread_local RowBytes bytes;
        thread_local Surroundings around;
        thread_local Candidates<Dim> candidates;
        run_begin.clear();
        bytes.clear();
        for (std::size_t k = 0; k < cells_per_block; ++k) {
          block.first_run[k] = static_cast<std::uint32_t>(run_begin.size());
          const std::size_t c = b * cells_per_block + k;
          if (c >= cells.size()) continue;
          find_surroundings<Dim>(table, cells[c].key, around);
          run_begin.insert(run_begin.end(), around.run_begin.begin(), around.run_begin.end());
          candidates.gather(position, position[cells[c].begin], radius, around);
          for (std::int32_t i = cells[c].begin; i < cells[c].end; ++i) {
            CHECK_LE(bytes.size(), std::numeric_limits<std::uint32_t>::max());
            lists.places[i] = {static_cast<std::uint32_t>(c), static_cast<std::uint32_t>(bytes.size())};
            longest[b] = std::max(longest[b], append_row<Dim>(candidates, position[i], radius2, around, i, bytes));
          }
        }
        block.first_run.back() = static_cast<std::uint32_t>(run_begin.size());
        bytes.end_at(std::fill_n(bytes.make_room(NeighbourLists::step), NeighbourLists::step, std::uint8_t{0}));
        replace<std::int32_t>(block.run_begin, run_begin);
        replace(block.bytes, bytes.written());
      },
      1);
  // In a rod, two cells further along it.
  const std::size_t n_across = Dim < 3 ? 0 : std::size_t{1} << (rod_y_bits + rod_z_bits);
  lists.look_ahead = cells.empty() ? 0 : 2 * n_across * position.size() / cells.size();
  lists.longest = longest.empty() ? 0 : *std::max_element(longest.begin(), longest.end());
}

std::size_t NeighbourLists::n_bytes() const {
  std::size_t n = places.size() * sizeof(places[0]) + blocks.size() * sizeof(Block) + names.size() * sizeof(names[0]);
  for (const Block& block : blocks)
    n += block.run_begin.capacity() * sizeof(block.run_begin[0]) + block.bytes.capacity();
  return n;
}

std::vector<std::int32_t> NeighbourLists::row(std::size_t i) const {
  std::vector<std::int32_t> buffer(room());
  buffer.resize(read(i, buffer.data()).neighbours.size());
  return buffer;
}

template Box<1> bounds_of<1>(std::span<const Vec<1>>);
template std::pmr::vector<std::int32_t> compute_cell_order<1>(std::span<const Vec<1>>, std::span<const std::int32_t>,
                                                              double, std::pmr::memory_resource*);
template Box<2> bounds_of<2>(std::span<const Vec<2>>);
template std::pmr::vector<std::int32_t> compute_cell_order<2>(std::span<const Vec<2>>, std::span<const std::int32_t>,
                                                              double, std::pmr::memory_resource*);
template Box<3> bounds_of<3>(std::span<const Vec<3>>);
template std::pmr::vector<std::int32_t> compute_cell_order<3>(std::span<const Vec<3>>, std::span<const std::int32_t>,
                                                              double, std::pmr::memory_resource*);
template void build_neighbour_lists<1>(std::span<const Vec<1>>, double, double, int, NeighbourLists&);
template void build_neighbour_lists<2>(std::span<const Vec<2>>, double, double, int, NeighbourLists&);
template void build_neighbour_lists<3>(std::span<const Vec<3>>, double, double, int, NeighbourLists&);

}  // namespace smelt
