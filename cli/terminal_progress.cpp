#include "cli/terminal_progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <sys/ioctl.h>
#include <unistd.h>

namespace smelt {

namespace {

// The one global of the program: a signal handler can reach nothing else.
volatile std::sig_atomic_t stop_requested = 0;

void request_stop(int signal) {
  stop_requested = 1;
  std::signal(signal, SIG_DFL);
}

std::string clock_text(double seconds) {
  const long s = std::max(0L, static_cast<long>(seconds + 0.5));
  return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60)
                  : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

std::size_t terminal_width() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

void print_to_stderr(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

TerminalProgress::TerminalProgress() : on_terminal_(isatty(STDERR_FILENO) != 0) {
  stop_requested = 0;
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
}

TerminalProgress::~TerminalProgress() {
  clear_line();
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

void TerminalProgress::update(const ProgressState& state) {
  using std::chrono::duration;
  const auto now = std::chrono::steady_clock::now();
  const double n_frames = state.last_frame - state.first_frame + 1;
  const double fraction = std::clamp((state.frame - state.first_frame + state.fraction) / n_frames, 0.0, 1.0);
  if (state.stage != stage_) {
    stage_ = state.stage;
    stage_start_ = now;
    stage_start_fraction_ = fraction;
    last_drawn_ = {};
  }
  if (!on_terminal_ || now - last_drawn_ < std::chrono::milliseconds(100)) return;
  last_drawn_ = now;

  const double elapsed = duration<double>(now - stage_start_).count();
  const double done = fraction - stage_start_fraction_;
  const std::string eta = done > 1e-4 && elapsed > 0.5 ? clock_text(elapsed / done * (1.0 - fraction)) : "--:--";
  constexpr int bar_width = 24;
  const int filled = static_cast<int>(fraction * bar_width);
  std::string line =
      fmt::format("{:<8} [{:=<{}}{:<{}}] frame {}/{}  {}  ETA {}", state.stage, "", filled,
                  filled < bar_width ? ">" : "", bar_width - filled, state.frame, state.last_frame, state.details, eta);
  line.resize(std::min(line.size(), terminal_width() - 1));
  print_to_stderr("\r\033[K" + line);
  line_shown_ = true;
}

void TerminalProgress::message(const std::string& text) {
  clear_line();
  print_to_stderr(fmt::format("smelt: {}\n", text));
}

bool TerminalProgress::should_stop() {
  return stop_requested != 0;
}

void TerminalProgress::clear_line() {
  if (line_shown_) print_to_stderr("\r\033[K");
  line_shown_ = false;
}

}  // namespace smelt
