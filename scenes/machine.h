#pragma once
// What machine this is, for reports of what took how long.

#include <fstream>
#include <string>

namespace smelt {

/// As the system names it: "AMD EPYC 7763 64-Core Processor".
inline std::string cpu_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name") && line.find(": ") != std::string::npos) return line.substr(line.find(": ") + 2);
  return "unknown processor";
}

}  // namespace smelt
