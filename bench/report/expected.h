#pragma once
// The errors that the quick suite had when they were stored: what it must not get worse than.

#include "bench/report/csv.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace smelt {

/// Errors by "method at resolution" by case.
using ExpectedErrors = std::map<std::string, std::map<std::string, double>>;

/// An error may be worse than the stored one by this share of it.
constexpr double expected_margin = 0.1;

/// Throws Error (file:line) where the file is missing or something else than tables of numbers.
ExpectedErrors read_expected(const std::filesystem::path& path);

/// Replaces those of the cases in `rows`, where every run must have gone well (else throws Error), and keeps those of
/// other cases.
void write_expected(const std::filesystem::path& path, ExpectedErrors kept, const std::vector<RunRow>& rows);

/// One sentence for each run that failed, is worse than stored by more than the margin, or has no stored error, and for
/// each stored error of a case in `rows` that no run belongs to. Times do not count.
std::vector<std::string> compare_with_expected(const ExpectedErrors& expected, const std::vector<RunRow>& rows);

}  // namespace smelt
