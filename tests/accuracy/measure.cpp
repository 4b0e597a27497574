#include "tests/accuracy/measure.h"

#include "core/error.h"
#include "tests/source_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>

namespace smelt {

double Reference::at(double x, std::size_t c) const {
  CHECK_LT(c, column.size());
  const std::vector<double>& xs = column[0];
  const std::vector<double>& ys = column[c];
  const bool rising = xs.front() < xs.back();
  CHECK_GE(x, rising ? xs.front() : xs.back());
  CHECK_LE(x, rising ? xs.back() : xs.front());
  const auto above =
      std::find_if(xs.begin() + 1, xs.end() - 1, [&](double value) { return rising ? value >= x : value <= x; });
  const auto k = static_cast<std::size_t>(above - xs.begin());
  const double t = (x - xs[k - 1]) / (xs[k] - xs[k - 1]);
  return (1.0 - t) * ys[k - 1] + t * ys[k];
}

Reference read_reference(const std::string& name) {
  const std::string path = source_folder().string() + "/tests/data/reference/" + name + ".csv";
  std::ifstream file(path);
  Reference reference;
  if (!std::getline(file, reference.header)) fail("{}: cannot be read", path);
  std::string line;
  for (int n = 2; std::getline(file, line); ++n) {
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) {
      char* end = nullptr;
      row.push_back(std::strtod(cell.c_str(), &end));
      if (cell.empty() || end != cell.c_str() + cell.size()) fail("{}:{}: \"{}\" is not a number", path, n, cell);
    }
    if (reference.column.empty()) reference.column.resize(row.size());
    if (row.size() != reference.column.size())
      fail("{}:{}: {} numbers where the rows before have {}", path, n, row.size(), reference.column.size());
    for (std::size_t c = 0; c < row.size(); ++c) reference.column[c].push_back(row[c]);
  }
  if (reference.column.size() < 2 || reference.column[0].size() < 2)
    fail("{}: needs two columns and two rows of numbers", path);
  return reference;
}

Norms compute_norms(std::span<const double> differences) {
  CHECK(!differences.empty());
  Norms norms;
  for (const double e : differences) {
    norms.l1 += std::abs(e);
    norms.l2 += e * e;
    if (!std::isnan(norms.max) && !(std::abs(e) <= norms.max)) norms.max = std::abs(e);  // a NaN stays one
  }
  norms.l1 /= static_cast<double>(differences.size());
  norms.l2 = std::sqrt(norms.l2 / static_cast<double>(differences.size()));
  return norms;
}

double convergence_order(std::span<const double> spacing, std::span<const double> error) {
  CHECK_EQ(spacing.size(), error.size());
  CHECK_GE(spacing.size(), 2u);
  const auto n = static_cast<double>(spacing.size());
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t k = 0; k < spacing.size(); ++k) {
    CHECK_GT(spacing[k], 0.0);
    CHECK_GT(error[k], 0.0);
    const double log_spacing = std::log(spacing[k]), log_error = std::log(error[k]);
    x += log_spacing;
    y += log_error;
    xx += log_spacing * log_spacing;
    xy += log_spacing * log_error;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

namespace {

std::string cell(const std::optional<double>& value, const char* none) {
  return value ? fmt::format("{:.3g}", *value) : std::string(none);
}

}  // namespace

void report_row(const Row& row) {
  for (const std::string* text : {&row.problem, &row.quantity, &row.resolution})
    CHECK_EQ(text->find_first_of(",|\n\""), std::string::npos);
  fmt::print("[ MEASURED ] {}: {} at {}: {:.3g}, bar {}; order {}, at least {}\n", row.problem, row.quantity,
             row.resolution, row.error, cell(row.bar, "none"), cell(row.order, "not measured"),
             cell(row.least_order, "none"));
  if (const char* folder = std::getenv("SMELT_ACCURACY_FOLDER")) {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    CHECK(test != nullptr);
    std::string name = fmt::format("{}.{}.csv", test->test_suite_name(), test->name());
    std::replace(name.begin(), name.end(), '/', '.');  // of parameterised tests
    const auto path = std::filesystem::path(folder) / name;
    std::ofstream file(path, std::ios::app);
    file << fmt::format("{},{},{},{:.3g},{},{},{}\n", row.problem, row.quantity, row.resolution, row.error,
                        cell(row.bar, ""), cell(row.order, ""), cell(row.least_order, ""));
    if (!file.flush()) fail("{}: cannot be written", path.string());
  }
  if (row.bar) {
    EXPECT_LE(row.error, *row.bar) << row.problem << ": " << row.quantity;
  }
  if (row.least_order) {
    ASSERT_TRUE(row.order) << row.problem << ": " << row.quantity << " has no order";
    EXPECT_GE(*row.order, *row.least_order) << row.problem << ": order of " << row.quantity;
  }
}

bool full_run() {
  const char* full = std::getenv("SMELT_FULL");
  return full != nullptr && std::string_view(full) == "1";
}

}  // namespace smelt
