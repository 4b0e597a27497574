#pragma once
// Other programs.

#include <string>
#include <vector>

namespace smelt {

/// Runs a program found in PATH, silent and without input; its exit status, 126 where a signal ended it, 127 where it
/// could not be started.
int run_program(const std::vector<std::string>& arguments);

}  // namespace smelt
