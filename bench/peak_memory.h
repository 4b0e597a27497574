#pragma once
// Resident memory of this process; needs Linux's /proc.

#include <fstream>
#include <limits>
#include <malloc.h>
#include <string>

namespace smelt {

/// Highest resident memory since the last reset [MiB].
inline double peak_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) / 1024.0;
  return std::numeric_limits<double>::quiet_NaN();
}

inline void reset_peak_memory() {
  ::malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

}  // namespace smelt
