#pragma once
// A full disk, for tests: files may not grow beyond a limit.

#include <csignal>
#include <sys/resource.h>

namespace smelt {

/// While it lives, writes beyond `n_bytes` of a file fail with EFBIG.
class DiskLimit {
 public:
  explicit DiskLimit(rlim_t n_bytes) {
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &old_limit_);
    const rlimit limit{n_bytes, old_limit_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~DiskLimit() {
    ::setrlimit(RLIMIT_FSIZE, &old_limit_);
    std::signal(SIGXFSZ, old_handler_);
  }
  DiskLimit(const DiskLimit&) = delete;
  DiskLimit& operator=(const DiskLimit&) = delete;

 private:
  rlimit old_limit_{};
  void (*old_handler_)(int) = SIG_DFL;
};

}  // namespace smelt
