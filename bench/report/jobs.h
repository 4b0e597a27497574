#pragma once
// Many computations, each on one thread.

#include "scenes/progress.h"

#include <cstddef>
#include <functional>

namespace smelt {

/// Runs job(0) to job(n - 1), begun in that order, as many at a time as there are `threads`, each on one thread alone
/// (so that its CPU seconds are its own), and after each calls finished(k): one call at a time. The first exception of
/// either ends the rest, and is thrown on. Throws Interrupted where the user asks to stop, after the jobs that had
/// begun.
void run_jobs(std::size_t n, unsigned threads, Progress& progress, const std::function<void(std::size_t)>& job,
              const std::function<void(std::size_t)>& finished);

}  // namespace smelt
