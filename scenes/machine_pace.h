#pragma once
// How fast this machine is when nothing else runs on it, so that a forecast made while it is busy holds for when it is
// not.

#include <filesystem>
#include <optional>

namespace smelt {

/// Where the pace is kept: smelt/pace.json in $XDG_CACHE_HOME, or in ~/.cache.
std::filesystem::path pace_file();

/// Seconds that a fixed piece of a simulation takes now, the least of several.
double time_fixed_work();

/// Measures it, for an idle machine, and keeps it. Throws Error where it cannot be written.
double calibrate_pace();

/// How many times as long work takes now as it took when the machine was calibrated, at least 1; nothing where it never
/// was, nor another one with the same home folder that is like it in processor, threads and smelt's version.
std::optional<double> measure_load();

}  // namespace smelt
