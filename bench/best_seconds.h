#pragma once
// Times work that other processes may disturb.

#include <algorithm>
#include <chrono>

namespace smelt {

/// Least time of `n_runs` of `run()` [s].
template <typename Run>
double best_seconds(int n_runs, const Run& run) {
  double best = 1e30;
  for (int k = 0; k < n_runs; ++k) {
    const auto start = std::chrono::steady_clock::now();
    run();
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best;
}

}  // namespace smelt
