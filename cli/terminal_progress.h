#pragma once
// A progress bar on a terminal; nothing but messages elsewhere.

#include "scenes/progress.h"

#include <chrono>
#include <string>

namespace smelt {

/// Writes `text` to stderr. Where that is a full disk or a closed pipe the text is lost, and nothing else.
void print_to_stderr(const std::string& text);

/// Draws `stage [=====>    ] frame 12/96  step 40 dt 2.8e-04 s  ETA 1:23` on stderr where that is a terminal. While it
/// lives SIGINT and SIGTERM ask the run to stop, which should_stop() tells (a second one ends it at once); else they
/// end the program as they do by default, as nobody would ask.
class TerminalProgress final : public Progress {
 public:
  TerminalProgress();
  ~TerminalProgress() override;
  TerminalProgress(const TerminalProgress&) = delete;
  TerminalProgress& operator=(const TerminalProgress&) = delete;

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
