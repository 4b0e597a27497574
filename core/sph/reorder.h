#pragma once
// Particles put in another order, or taken out.

#include "core/error.h"
#include "core/parallel.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace smelt {

/// Entry i becomes what entry order[i] was, by way of `scratch`, of at least as many bytes. A second array would cost
/// more than the copy back: its pages are new to the process each time. Empty arrays stay empty.
template <typename T>
void reorder(std::vector<T>& values, std::span<const std::int32_t> order, std::span<std::byte> scratch) {
  if (values.empty()) return;
  CHECK_EQ(values.size(), order.size());
  CHECK_LE(values.size() * sizeof(T), scratch.size());
  parallel_blocks(values.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const T& from = values[static_cast<std::size_t>(order[i])];
      std::memcpy(scratch.data() + i * sizeof(T), static_cast<const void*>(&from), sizeof(T));
    }
  });
  parallel_blocks(values.size(), [&](std::size_t begin, std::size_t end) {
    std::memcpy(static_cast<void*>(&values[begin]), scratch.data() + begin * sizeof(T), (end - begin) * sizeof(T));
  });
}

/// Keeps the entries that `kept` names, in order. Empty arrays stay empty.
template <typename T>
void keep_only(std::vector<T>& values, std::span<const std::int32_t> kept) {
  if (values.empty()) return;
  for (std::size_t k = 0; k < kept.size(); ++k) values[k] = values[static_cast<std::size_t>(kept[k])];
  values.resize(kept.size());
}

}  // namespace smelt
