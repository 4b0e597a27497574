#pragma once
// Sorted lists of lattice keys, made on all cores.

#include "core/parallel.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace smelt {

inline void sort_unique(std::vector<std::uint64_t>& keys) {
  tbb::parallel_sort(keys);
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
}

/// The keys that list(i, keys) appends for each i in [0, n), ascending, each once.
template <typename List>
std::vector<std::uint64_t> collect_keys(std::size_t n, const List& list) {
  constexpr std::size_t part_size = 256;
  std::vector<std::vector<std::uint64_t>> parts((n + part_size - 1) / part_size);
  parallel_blocks(
      parts.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t part = begin; part < end; ++part) {
          std::vector<std::uint64_t>& keys = parts[part];
          for (std::size_t i = part * part_size; i < std::min(n, (part + 1) * part_size); ++i) list(i, keys);
          std::sort(keys.begin(), keys.end());
          keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
        }
      },
      1);
  std::size_t n_keys = 0;
  for (const auto& part : parts) n_keys += part.size();
  std::vector<std::uint64_t> all;
  all.reserve(n_keys);
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  sort_unique(all);
  return all;
}

}  // namespace smelt
