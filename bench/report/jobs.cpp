#include "bench/report/jobs.h"

#include "core/error.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace smelt {

namespace {

/// A queue of jobs that several threads work through.
class Jobs {
 public:
  Jobs(std::size_t n, Progress& progress, const std::function<void(std::size_t)>& job,
       const std::function<void(std::size_t)>& finished)
      : n_(n), progress_(progress), job_(job), finished_(finished) {}

  void work() {
    tbb::task_arena alone(1);
    for (std::size_t k = take(); k < n_; k = take()) {
      try {
        alone.execute([&] { job_(k); });
        const std::lock_guard lock(mutex_);
        finished_(k);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!error_) error_ = std::current_exception();
      }
    }
  }

  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
    if (stopped_) throw Interrupted("interrupted; what was done is in the report");
  }

 private:
  /// The next job, or n_ where there is none to begin.
  std::size_t take() {
    const std::lock_guard lock(mutex_);
    if (next_ == n_ || error_) return n_;
    stopped_ = stopped_ || progress_.should_stop();
    return stopped_ ? n_ : next_++;
  }

  std::size_t n_;
  Progress& progress_;
  const std::function<void(std::size_t)>& job_;
  const std::function<void(std::size_t)>& finished_;
  std::mutex mutex_;
  std::size_t next_ = 0;
  bool stopped_ = false;
  std::exception_ptr error_;
};

}  // namespace

void run_jobs(std::size_t n, unsigned threads, Progress& progress, const std::function<void(std::size_t)>& job,
              const std::function<void(std::size_t)>& finished) {
  Jobs jobs(n, progress, job, finished);
  std::vector<std::jthread> workers;
  for (unsigned k = 0; k < std::max(1u, threads); ++k) workers.emplace_back([&] { jobs.work(); });
  workers.clear();  // waits for them
  jobs.rethrow();
}

}  // namespace smelt
