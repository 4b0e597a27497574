#pragma once
// Runs a measurement in a process of its own, so that its peak memory is its alone.

#include "core/error.h"

#include <cstdlib>
#include <sys/wait.h>
#include <type_traits>
#include <unistd.h>

namespace smelt {

/// What `measure()` returns in a child process. To be called before this process has any threads. Throws InternalError
/// where the child fails.
template <typename Measure>
auto run_in_child(const Measure& measure) {
  using Result = decltype(measure());
  static_assert(std::is_trivially_copyable_v<Result>);
  int ends[2];
  if (pipe(ends) != 0) throw InternalError("bench: no pipe");
  const pid_t child = fork();
  if (child < 0) throw InternalError("bench: no child process");
  if (child == 0) {
    const Result result = measure();
    std::_Exit(write(ends[1], &result, sizeof result) == static_cast<ssize_t>(sizeof result) ? 0 : 1);
  }
  close(ends[1]);
  Result result;
  const bool whole = read(ends[0], &result, sizeof result) == static_cast<ssize_t>(sizeof result);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (!whole || status != 0) throw InternalError("bench: the child process failed");
  return result;
}

}  // namespace smelt
