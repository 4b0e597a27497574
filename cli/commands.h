#pragma once
// The command line: one table of commands and options, and what errors become there.

namespace smelt {

/// Exit status of a command (docs/conventions.md).
enum ExitCode {
  exit_done = 0,
  exit_internal = 1,
  exit_usage = 2,
  exit_bad_input = 3,
  exit_diverged = 4,
  exit_interrupted = 130
};

/// Runs one command. Results go to stdout, messages and progress to stderr. Never throws.
int run_command_line(int argc, char** argv);

}  // namespace smelt
