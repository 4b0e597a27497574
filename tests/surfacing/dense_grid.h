#pragma once
// Small dense grids of samples for the tests, and their way into a sparse field.

#include "surfacing/sparse_field.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace smelt::testing {

/// Samples (0..n[0]-1, 0..n[1]-1, 0..n[2]-1), x fastest; everything around them is 0.
struct DenseGrid {
  Lattice n{};
  std::vector<float> value;
  float& at(int i, int j, int k) { return value[static_cast<std::size_t>(i + n[0] * (j + n[1] * k))]; }
  float at(int i, int j, int k) const { return value[static_cast<std::size_t>(i + n[0] * (j + n[1] * k))]; }
};

inline DenseGrid make_grid(Lattice n, float value = 0.0f) {
  return {n, std::vector<float>(static_cast<std::size_t>(n[0]) * n[1] * n[2], value)};
}

/// The grid with its first sample at lattice point `origin`, and one layer of blocks around it.
inline SparseField make_sparse(const DenseGrid& grid, Lattice origin = {0, 0, 0}, double cell = 1.0) {
  SparseField field;
  field.cell = cell;
  const auto block_of = [](int sample) { return sample >> 3; };
  Lattice low, high;
  for (int a = 0; a < 3; ++a) {
    low[a] = block_of(origin[a] - 1);
    high[a] = block_of(origin[a] + grid.n[a] - 1);
  }
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) field.key.push_back(lattice_key(x, y, z));
  field.value.assign(field.key.size() * SparseField::block_size, 0.0f);
  for (int k = 0; k < grid.n[2]; ++k)
    for (int j = 0; j < grid.n[1]; ++j)
      for (int i = 0; i < grid.n[0]; ++i) {
        const int x = origin[0] + i, y = origin[1] + j, z = origin[2] + k;
        const std::size_t block = field.find(lattice_key(block_of(x), block_of(y), block_of(z)));
        field.value[block * SparseField::block_size + (x & 7) + 8 * ((y & 7) + 8 * (z & 7))] = grid.at(i, j, k);
      }
  return field;
}

}  // namespace smelt::testing
