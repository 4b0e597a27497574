#include "tests/accuracy/measure.h"

#include "core/error.h"
#include "tests/source_folder.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>

namespace smelt {
namespace {

TEST(Measure, EveryReferenceCanBeRead) {
  int n = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder() / "bench" / "reference")) {
    if (entry.path().extension() != ".csv") continue;
    ++n;
    EXPECT_NO_THROW(read_reference(entry.path().stem().string())) << entry.path();
  }
  EXPECT_GT(n, 10);
  EXPECT_THROW(read_reference("no_such_problem"), Error);
}

TEST(Measure, InterpolatesBetweenRowsAndNeverBeyond) {
  const Reference rising{"", {{0.0, 1.0, 3.0}, {5.0, 7.0, 3.0}}};
  EXPECT_DOUBLE_EQ(rising.at(0.0), 5.0);
  EXPECT_DOUBLE_EQ(rising.at(0.5), 6.0);
  EXPECT_DOUBLE_EQ(rising.at(2.5), 4.0);
  EXPECT_DOUBLE_EQ(rising.at(3.0), 3.0);
  EXPECT_THROW(rising.at(3.1), InternalError);
  const Reference falling{"", {{3.0, 1.0, 0.0}, {3.0, 7.0, 5.0}}};
  EXPECT_DOUBLE_EQ(falling.at(2.5), 4.0);
  EXPECT_DOUBLE_EQ(falling.at(0.5), 6.0);
}

TEST(Measure, Norms) {
  const std::array<double, 4> differences{3.0, -1.0, 0.0, -5.0};
  const Norms norms = compute_norms(differences);
  EXPECT_DOUBLE_EQ(norms.l1, 9.0 / 4.0);
  EXPECT_DOUBLE_EQ(norms.l2, std::sqrt(35.0 / 4.0));
  EXPECT_DOUBLE_EQ(norms.max, 5.0);
}

TEST(Measure, OrderOfAPowerLaw) {
  const std::array<double, 3> spacing{0.1, 0.05, 0.02};
  std::array<double, 3> error{};
  for (std::size_t k = 0; k < 3; ++k) error[k] = 7.0 * std::pow(spacing[k], 1.7);
  EXPECT_NEAR(convergence_order(spacing, error), 1.7, 1e-12);
}

}  // namespace
}  // namespace smelt
