#include "surfacing/marching_cubes.h"

#include "core/error.h"
#include "surfacing/cell_deciders.h"
#include "surfacing/marching_cubes_table.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>

namespace smelt {

namespace {

constexpr int edge = SparseField::block_edge;
constexpr int halo = edge + 1;  // samples along an edge of a block with those its cells share with the next
constexpr double nearest_to_sample = 0.01;
constexpr std::uint16_t not_crossed = 0xffff;

/// A block's samples minus the iso-value, and those of the layer above it along each axis; one bit each: inside or not.
struct Window {
  std::array<float, halo * halo * halo> f;
  std::array<unsigned, halo * halo> row;  // bit i: sample (i, j, k) is inside; index j + 9 k
  bool uniform = true;

  float at(int i, int j, int k) const { return f[i + halo * (j + halo * k)]; }
};

/// Sample minus iso-value, never 0: the rule for ties of marching_cubes.h. A function of the sample alone, so all cells
/// agree.
float above_iso(float sample, float iso) {
  const float f = sample - iso;
  return f == 0.0f ? iso * tie_lift : f;
}

/// The block and its 7 neighbours above: bit a of the index is a step along axis a.
using Neighbours = std::array<std::size_t, 8>;

std::uint64_t key_above(const Lattice& p, int n) {
  return lattice_key(p[0] + (n & 1), p[1] + (n >> 1 & 1), p[2] + (n >> 2 & 1));
}

Neighbours neighbours_above(const SparseField& field, std::size_t block) {
  Neighbours at;
  const Lattice p = lattice_from_key(field.key[block]);
  for (int n = 0; n < 8; ++n) at[n] = n == 0 ? block : field.find(key_above(p, n));
  return at;
}

Window load_window(const SparseField& field, const Lattice& p, const Neighbours& blocks, float iso) {
  Window w;
  std::array<float, 8> absent{};  // value of the neighbours that are not stored
  for (int n = 1; n < 8; ++n)
    if (blocks[n] == SparseField::no_block) absent[n] = field.absent_value(key_above(p, n));
  unsigned any = 0, all = (1u << halo) - 1;
  for (int k = 0; k < halo; ++k)
    for (int j = 0; j < halo; ++j) {
      const int above = (j / edge) << 1 | (k / edge) << 2;
      const int offset = edge * (j % edge + edge * (k % edge));
      const std::size_t here = blocks[above], next = blocks[above | 1];
      const float* line =
          here == SparseField::no_block ? nullptr : &field.value[here * SparseField::block_size + offset];
      float* f = &w.f[halo * (j + halo * k)];
      for (int i = 0; i < edge; ++i) f[i] = above_iso(line ? line[i] : absent[above], iso);
      f[edge] = above_iso(
          next == SparseField::no_block ? absent[above | 1] : field.value[next * SparseField::block_size + offset],
          iso);
      unsigned bits = 0;
      for (int i = 0; i < halo; ++i) bits |= static_cast<unsigned>(f[i] >= 0.0f) << i;
      w.row[j + halo * k] = bits;
      any |= bits;
      all &= bits;
    }
  w.uniform = any == 0 || all == (1u << halo) - 1;
  return w;
}

/// A corner of a triangle before vertices are numbered: an inner vertex of the block, or the edge (axis, lower sample)
/// of the block itself or of a neighbour above.
struct CornerCode {
  std::uint16_t bits;
  static constexpr unsigned inner_bit = 0x8000, slot_mask = 0x7ff;
  static CornerCode inner(std::size_t i) { return {static_cast<std::uint16_t>(inner_bit | i)}; }
  static CornerCode on_edge(int neighbour, int slot) { return {static_cast<std::uint16_t>(neighbour << 11 | slot)}; }
  bool is_inner() const { return (bits & inner_bit) != 0; }
  unsigned inner_index() const { return bits & ~inner_bit; }
  unsigned neighbour() const { return bits >> 11; }
  unsigned slot() const { return bits & slot_mask; }
};
constexpr int n_slots = SparseField::edges_per_block;

/// What one block adds to the mesh.
struct BlockSurface {
  Neighbours neighbours{};
  std::vector<std::uint16_t> vertex_of_slot;  // empty where the block has no vertex
  std::vector<Vec3> edge_vertices, inner_vertices;
  std::vector<std::array<CornerCode, 3>> triangles;
  std::uint32_t first_vertex = 0;
  std::size_t first_triangle = 0;
};

/// Where the surface comes near the lower sides the blocks below are needed: otherwise cells there would never be
/// visited.
void check_padding(const SparseField& field, const Lattice& p, const Window& w) {
  for (int n = 1; n < 8; ++n) {
    const unsigned all = (n & 1) != 0 ? 1u : 255u;
    unsigned some = 0, every = all;
    for (int k = 0; k < ((n & 4) != 0 ? 1 : edge); ++k)
      for (int j = 0; j < ((n & 2) != 0 ? 1 : edge); ++j) {
        some |= w.row[j + halo * k] & all;
        every &= w.row[j + halo * k];
      }
    const std::uint64_t below = lattice_key(p[0] - (n & 1), p[1] - (n >> 1 & 1), p[2] - (n >> 2 & 1));
    if (field.find(below) != SparseField::no_block) continue;
    CHECK(field.absent_value(below) > 0.0f ? every == all : some == 0);
  }
}

/// Bits of the crossed edges along `axis` whose lower samples are the first 8 of row (j, k).
unsigned crossed_edges(const Window& w, int axis, int j, int k) {
  const unsigned row = w.row[j + halo * k];
  const unsigned other = axis == 0 ? row >> 1 : axis == 1 ? w.row[j + 1 + halo * k] : w.row[j + halo * (k + 1)];
  return (row ^ other) & 255u;
}

/// Where the surface crosses the edge along `axis` from sample (i, j, k) of block p, in cells.
Vec3 crossing(const Window& w, const Lattice& p, int axis, int i, int j, int k) {
  const double low = w.at(i, j, k), high = w.at(i + (axis == 0), j + (axis == 1), k + (axis == 2));
  Vec3 x(edge * p[0] + i, edge * p[1] + j, edge * p[2] + k);
  x[axis] += std::clamp(low / (low - high), nearest_to_sample, 1.0 - nearest_to_sample);
  return x;
}

void place_edge_vertices(BlockSurface& out, const Lattice& p, const Window& w, double cell) {
  out.vertex_of_slot.assign(n_slots, not_crossed);
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < edge; ++k)
      for (int j = 0; j < edge; ++j)
        for (unsigned bits = crossed_edges(w, axis, j, k); bits != 0; bits &= bits - 1) {
          const int i = std::countr_zero(bits);
          out.vertex_of_slot[axis * SparseField::block_size + i + edge * (j + edge * k)] =
              static_cast<std::uint16_t>(out.edge_vertices.size());
          out.edge_vertices.push_back(cell * crossing(w, p, axis, i, j, k));
        }
}

const CellSurface& choose_surface(const Window& w, std::uint8_t pattern, int i, int j, int k) {
  static const MarchingCubesTable& table = marching_cubes_table();
  const std::uint8_t ambiguous = table.ambiguous_faces[pattern];
  const CellCase& plain = table.cases[table.first[pattern]];
  if (ambiguous == 0 && plain.tunnels.empty()) return plain.discs;

  CellSamples sample;
  for (int n = 0; n < 8; ++n) sample[n] = w.at(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2 & 1));
  const CellCase& cell = table.find(pattern, decide_faces(sample, ambiguous));
  const CellTunnel* tunnel = find_tunnel(sample, cell);
  return tunnel ? tunnel->surface : cell.discs;
}

/// Calls visit(i, j, k, pattern) for each cell of the block that the surface cuts.
template <typename Visit>
void for_each_cut_cell(const Window& w, Visit&& visit) {
  for (int k = 0; k < edge; ++k)
    for (int j = 0; j < edge; ++j) {
      const unsigned r00 = w.row[j + halo * k], r10 = w.row[j + 1 + halo * k];
      const unsigned r01 = w.row[j + halo * (k + 1)], r11 = w.row[j + 1 + halo * (k + 1)];
      const unsigned some = r00 | r10 | r01 | r11, every = r00 & r10 & r01 & r11;
      for (unsigned bits = (some | some >> 1) & ~(every & every >> 1) & 255u; bits != 0; bits &= bits - 1) {
        const int i = std::countr_zero(bits);
        const unsigned pattern = (r00 >> i & 3u) | (r10 >> i & 3u) << 2 | (r01 >> i & 3u) << 4 | (r11 >> i & 3u) << 6;
        visit(i, j, k, static_cast<std::uint8_t>(pattern));
      }
    }
}

void place_cell_surface(BlockSurface& out, const CellSurface& surface, const Lattice& p, const Window& w, double cell,
                        int i, int j, int k) {
  const std::size_t first_inner = out.inner_vertices.size();
  for (const auto& mean_of : surface.inner) {
    Vec3 sum = Vec3::Zero();
    for (const std::uint8_t e : mean_of) {
      const int low = edge_corners(e)[0];
      sum += crossing(w, p, e >> 2, i + (low & 1), j + (low >> 1 & 1), k + (low >> 2 & 1));
    }
    out.inner_vertices.push_back(cell / static_cast<double>(mean_of.size()) * sum);
  }
  for (const auto& triangle : surface.triangles) {
    std::array<CornerCode, 3> codes;
    for (int n = 0; n < 3; ++n) {
      const int id = triangle[n];
      if (id >= 12) {
        codes[n] = CornerCode::inner(first_inner + id - 12);
        continue;
      }
      const int low = edge_corners(id)[0];
      const int x = i + (low & 1), y = j + (low >> 1 & 1), z = k + (low >> 2 & 1);
      const int sample = x % edge + edge * (y % edge + edge * (z % edge));
      codes[n] = CornerCode::on_edge(x / edge | (y / edge) << 1 | (z / edge) << 2,
                                     (id >> 2) * SparseField::block_size + sample);
    }
    out.triangles.push_back(codes);
  }
}

/// Everything about a block that does not need to know how others number their vertices.
BlockSurface cut_block(const SparseField& field, std::size_t block, float iso) {
  BlockSurface out;
  out.neighbours = neighbours_above(field, block);
  const Lattice p = lattice_from_key(field.key[block]);
  const Window w = load_window(field, p, out.neighbours, iso);
  check_padding(field, p, w);
  if (w.uniform) return out;
  place_edge_vertices(out, p, w, field.cell);
  for_each_cut_cell(w, [&](int i, int j, int k, std::uint8_t pattern) {
    place_cell_surface(out, choose_surface(w, pattern, i, j, k), p, w, field.cell, i, j, k);
  });
  return out;
}

void copy_block(TriangleMesh& mesh, const std::vector<BlockSurface>& blocks, std::size_t b) {
  const BlockSurface& block = blocks[b];
  const auto first_inner =
      std::copy(block.edge_vertices.begin(), block.edge_vertices.end(), mesh.vertices.begin() + block.first_vertex);
  std::copy(block.inner_vertices.begin(), block.inner_vertices.end(), first_inner);
  const auto inner_offset = static_cast<std::uint32_t>(first_inner - mesh.vertices.begin());
  auto* triangle = mesh.triangles.data() + block.first_triangle;
  for (const auto& codes : block.triangles) {
    for (int n = 0; n < 3; ++n) {
      if (codes[n].is_inner()) {
        (*triangle)[n] = inner_offset + codes[n].inner_index();
        continue;
      }
      const BlockSurface& owner = blocks[block.neighbours[codes[n].neighbour()]];
      (*triangle)[n] = owner.first_vertex + owner.vertex_of_slot[codes[n].slot()];
    }
    ++triangle;
  }
}

}  // namespace

TriangleMesh extract_iso_surface(const SparseField& field, float iso) {
  if (!(iso > 0.0f)) fail("surfacing: the iso-value is {}: it must be positive, as the field is 0 far away", iso);
  const std::size_t n_blocks = field.n_blocks();
  std::vector<BlockSurface> blocks(n_blocks);
  tbb::parallel_for(std::size_t{0}, n_blocks, [&](std::size_t b) { blocks[b] = cut_block(field, b, iso); });

  std::uint64_t n_vertices = 0, n_triangles = 0;
  for (BlockSurface& block : blocks) {
    block.first_vertex = static_cast<std::uint32_t>(n_vertices);
    block.first_triangle = n_triangles;
    n_vertices += block.edge_vertices.size() + block.inner_vertices.size();
    n_triangles += block.triangles.size();
    // Three corners each: who is next to whom is counted by 32 bits (surfacing/mesh_adjacency.h).
    if (3 * n_triangles > 0xffffffffu)
      fail("surfacing: the surface has more than 2^32/3 triangles; take coarser cells (surface.cell_over_spacing)");
  }

  TriangleMesh mesh;
  mesh.vertices.resize(n_vertices);
  mesh.triangles.resize(n_triangles);
  tbb::parallel_for(std::size_t{0}, n_blocks, [&](std::size_t b) { copy_block(mesh, blocks, b); });
  return mesh;
}

}  // namespace smelt
