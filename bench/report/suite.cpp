#include "bench/report/suite.h"

#include "core/error.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

namespace smelt {

namespace {

/// The cases' runs as a queue that several threads work through.
class Suite {
 public:
  Suite(const std::vector<Case>& cases, bool quick, Progress& progress, const std::function<void(CaseResult)>& done)
      : progress_(progress), done_(done) {
    for (std::size_t c = 0; c < cases.size(); ++c) {
      results_.push_back({cases[c], {}});
      for (std::size_t m = 0; m < cases[c].methods.size(); ++m)
        for (const double resolution : quick ? cases[c].quick : cases[c].full) {
          places_.push_back({c, results_[c].runs.size()});
          results_[c].runs.push_back({.method = m, .resolution = resolution});
        }
      left_.push_back(results_[c].runs.size());
    }
  }

  void work() {
    tbb::task_arena alone(1);
    for (std::size_t k = next_++; k < places_.size() && !stopped(); k = next_++) {
      const auto [c, r] = places_[k];
      alone.execute([&] { perform(results_[c].problem, results_[c].runs[r]); });
      finish(c, r);
    }
  }

  /// What `done` threw, or Interrupted.
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
    if (stop_) throw Interrupted("interrupted; the cases that were done are in the report");
  }

 private:
  struct Place {
    std::size_t problem, run;
  };

  static void perform(const Case& problem, Run& run) {
    try {
      run.measured = problem.run(run.method, run.resolution);
    } catch (const std::exception& error) {
      run.failure = error.what();
    }
  }

  void finish(std::size_t c, std::size_t r) {
    const std::lock_guard lock(mutex_);
    const Case& problem = results_[c].problem;
    const Run& run = results_[c].runs[r];
    const std::string which = fmt::format("{}, {} at {:g}", problem.name, problem.methods[run.method], run.resolution);
    progress_.message(run.failed() ? fmt::format("{} failed: {}", which, run.failure)
                                   : fmt::format("{}: error {:.3g}, {:.1f} CPU seconds", which, run.measured.error, run.measured.cpu_seconds));
    if (--left_[c] > 0) return;
    try {
      done_(std::move(results_[c]));
    } catch (...) {
      if (!error_) error_ = std::current_exception();
      stop_ = true;
    }
  }

  bool stopped() {
    const std::lock_guard lock(mutex_);
    stop_ = stop_ || progress_.should_stop();
    return stop_;
  }

  Progress& progress_;
  const std::function<void(CaseResult)>& done_;
  std::vector<CaseResult> results_;
  std::vector<Place> places_;
  std::vector<std::size_t> left_;  ///< runs of each case
  std::atomic<std::size_t> next_ = 0;
  std::mutex mutex_;
  bool stop_ = false;
  std::exception_ptr error_;
};

}  // namespace

bool CaseResult::failed() const {
  return std::any_of(runs.begin(), runs.end(), [](const Run& run) { return run.failed(); });
}

void run_suite(const std::vector<Case>& cases, bool quick, unsigned threads, Progress& progress, const std::function<void(CaseResult)>& done) {
  Suite suite(cases, quick, progress, done);
  std::vector<std::jthread> workers;
  for (unsigned k = 0; k < std::max(1u, threads); ++k) workers.emplace_back([&] { suite.work(); });
  workers.clear();
  suite.rethrow();
}

}  // namespace smelt
