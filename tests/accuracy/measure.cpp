#include "tests/accuracy/measure.h"

#include "core/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace smelt {

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
