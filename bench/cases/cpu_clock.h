#pragma once

#include <ctime>

namespace smelt {

/// CPU seconds that the calling thread has spent since the object was made: those of a whole computation where it runs
/// on this thread alone.
class CpuClock {
 public:
  double seconds() const { return now() - start_; }

 private:
  static double now() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
  double start_ = now();
};

}  // namespace smelt
