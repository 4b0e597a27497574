#pragma once
// Loops on oneTBB whose results do not depend on the number of threads.

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/partitioner.h>

#include <cstddef>

namespace smelt {

/// Particles in one task: long enough to hide the cost of a task, short enough to balance two cores on 10^4 particles.
inline constexpr std::size_t block_size = 256;

/// Calls body(begin, end) over [0, n) in blocks; blocks must be independent.
template <typename Body>
void parallel_blocks(std::size_t n, const Body& body, std::size_t grain = block_size) {
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, n, grain),
      [&](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); },
      tbb::simple_partitioner());
}

/// Calls body(i) for i in [0, n).
template <typename Body>
void parallel_for_each(std::size_t n, const Body& body) {
  parallel_blocks(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

/// Reduces map(begin, end), of blocks of up to block_size, over [0, n) in a tree that depends on n alone, so that sums
/// round the same way on any number of threads.
template <typename Value, typename Map, typename Join>
Value deterministic_reduce_blocks(std::size_t n, const Value& identity, const Map& map, const Join& join) {
  return tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, n, block_size), identity,
      [&](const tbb::blocked_range<std::size_t>& range, const Value& value) {
        return join(value, map(range.begin(), range.end()));
      },
      join);
}

/// The same of map(i).
template <typename Value, typename Map, typename Join>
Value deterministic_reduce(std::size_t n, const Value& identity, const Map& map, const Join& join) {
  return deterministic_reduce_blocks(
      n, identity,
      [&](std::size_t begin, std::size_t end) {
        Value value = identity;
        for (std::size_t i = begin; i < end; ++i) value = join(value, map(i));
        return value;
      },
      join);
}

}  // namespace smelt
