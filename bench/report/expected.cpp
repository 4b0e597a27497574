#include "bench/report/expected.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/toml.h"

#include <iterator>
#include <set>

namespace smelt {

namespace {

std::string key_of(const RunRow& row) {
  return fmt::format("{} at {:g}", row.method, row.resolution);
}

}  // namespace

ExpectedErrors read_expected(const std::filesystem::path& path) {
  ExpectedErrors expected;
  for (const auto& [problem, errors] : parse_toml_file(path)) {
    const toml::table* table = errors.as_table();
    if (table == nullptr)
      fail("{}:{}: {} must be a table of errors", path.string(), errors.source().begin.line, problem.str());
    for (const auto& [key, value] : *table) {
      const auto error = value.value<double>();
      if (!error) fail("{}:{}: \"{}\" must be a number", path.string(), value.source().begin.line, key.str());
      expected[std::string(problem.str())][std::string(key.str())] = *error;
    }
  }
  return expected;
}

void write_expected(const std::filesystem::path& path, ExpectedErrors kept, const std::vector<RunRow>& rows) {
  for (const RunRow& row : rows) {
    if (!row.failure.empty())
      fail("{}, {} failed: errors are not stored, so that {} stays as it was", row.problem, key_of(row), path.string());
    kept.erase(row.problem);
  }
  for (const RunRow& row : rows) kept[row.problem][key_of(row)] = row.error;
  std::string text = fmt::format(
      "# Errors of the quick suite: `./smelt report --quick --check` fails where one is worse by more than {:g} %.\n"
      "# Made by `./smelt report --quick --write-expected`.\n",
      100.0 * expected_margin);
  for (const auto& [problem, errors] : kept) {
    text += fmt::format("\n[{}]\n", problem);
    for (const auto& [key, error] : errors) text += fmt::format("\"{}\" = {:.4g}\n", key, error);
  }
  write_file_atomically(path, text);
}

std::vector<std::string> compare_with_expected(const ExpectedErrors& expected, const std::vector<RunRow>& rows) {
  std::vector<std::string> complaints;
  ExpectedErrors missing;
  for (const RunRow& row : rows)
    if (const auto stored = expected.find(row.problem); stored != expected.end()) missing[row.problem] = stored->second;
  for (const RunRow& row : rows) {
    const std::string key = key_of(row);
    const auto problem = expected.find(row.problem);
    const double* stored =
        problem != expected.end() && problem->second.contains(key) ? &problem->second.at(key) : nullptr;
    missing[row.problem].erase(key);
    if (!row.failure.empty())
      complaints.push_back(fmt::format("{}, {} failed: {}", row.problem, key, row.failure));
    else if (stored == nullptr)
      complaints.push_back(fmt::format("{}, {} has no stored error", row.problem, key));
    else if (!(row.error <= (1.0 + expected_margin) * *stored))
      complaints.push_back(fmt::format("{}, {}: the error is {:.4g}, stored is {:.4g} ({:+.0f} %)", row.problem, key,
                                       row.error, *stored, 100.0 * (row.error / *stored - 1.0)));
  }
  for (const auto& [problem, errors] : missing)
    for (const auto& [key, error] : errors)
      complaints.push_back(fmt::format("{}, {} is stored, and no run belongs to it", problem, key));
  return complaints;
}

}  // namespace smelt
