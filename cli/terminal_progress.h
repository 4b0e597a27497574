#pragma once
// A progress bar on a terminal; nothing but messages elsewhere.

#include "scenes/progress.h"

#include <chrono>
#include <string>

namespace smelt {

/// From now on SIGINT and SIGTERM ask the run to stop (a second one ends it at once), and a file that grows past the
/// system's limit is an error of the writer instead of a signal.
void install_signal_handlers();

/// Draws `stage [=====>    ] frame 12/96  step 40 dt 2.8e-04 s  ETA 1:23` on stderr where that is a terminal.
class TerminalProgress final : public Progress {
 public:
  TerminalProgress();
  ~TerminalProgress() override;

  void update(const ProgressState& state) override;
  void message(const std::string& text) override;
  bool should_stop() override;

 private:
  void clear_line();

  bool on_terminal_;
  bool line_shown_ = false;
  std::string stage_;
  double stage_start_fraction_ = 0.0;
  std::chrono::steady_clock::time_point stage_start_;
  std::chrono::steady_clock::time_point last_drawn_;
};

}  // namespace smelt
