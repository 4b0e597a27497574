#include "core/sph/neighbours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace smelt {
namespace {

template <int Dim>
std::vector<Vec<Dim>> random_points(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Vec<Dim>> points(n);
  for (auto& x : points)
    for (int a = 0; a < Dim; ++a) x[a] = uniform(random);
  return points;
}

template <int Dim>
void expect_all_pairs(std::vector<Vec<Dim>> points, double radius) {
  std::vector<std::int32_t> id(points.size());
  std::iota(id.begin(), id.end(), 0);
  const auto order = compute_cell_order<Dim>(points, id, radius);
  std::vector<Vec<Dim>> sorted;
  for (const auto i : order) sorted.push_back(points[i]);
  NeighbourLists lists;
  build_neighbour_lists<Dim>(sorted, radius, radius, 8, lists);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    // What is farther than the radius by no more than single precision tells apart may be there.
    std::vector<std::int32_t> within, hardly_beyond;
    for (std::size_t j = 0; j < sorted.size(); ++j) {
      const double r = j == i ? 2.0 * radius : (sorted[i] - sorted[j]).norm();
      if (r < radius) within.push_back(static_cast<std::int32_t>(j));
      if (r < radius * (1.0 + 3e-6)) hardly_beyond.push_back(static_cast<std::int32_t>(j));
    }
    std::vector<std::int32_t> found = lists.row(i);
    std::sort(found.begin(), found.end());
    ASSERT_TRUE(std::includes(found.begin(), found.end(), within.begin(), within.end())) << "particle " << i;
    ASSERT_TRUE(std::includes(hardly_beyond.begin(), hardly_beyond.end(), found.begin(), found.end()))
        << "particle " << i;
    std::vector<std::int32_t> buffer(lists.room());
    const NeighbourLists::Row row = lists.read(i, buffer.data());
    ASSERT_EQ(row.neighbours.size(), found.size());
    ASSERT_EQ(row.padded.size() % 8, 0u);
    for (const auto k : row.padded.subspan(row.neighbours.size()))
      ASSERT_EQ(k, static_cast<std::int32_t>(i)) << "rows are padded with the particle itself";
  }
}

TEST(Neighbours, MatchesBruteForceIn1D) {
  expect_all_pairs<1>(random_points<1>(300, 1), 0.05);
}
TEST(Neighbours, MatchesBruteForceIn2D) {
  expect_all_pairs<2>(random_points<2>(800, 2), 0.17);
}
TEST(Neighbours, MatchesBruteForceIn3D) {
  expect_all_pairs<3>(random_points<3>(1500, 3), 0.31);
}
TEST(Neighbours, OneParticleHasNone) {
  expect_all_pairs<3>({Vec3(1.0, 2.0, 3.0)}, 0.5);
}
TEST(Neighbours, CoincidentParticlesSeeEachOther) {
  expect_all_pairs<3>({Vec3(1, 2, 3), Vec3(1, 2, 3), Vec3(1, 2, 3.1)}, 0.5);
}

/// More of them in reach than a byte can count.
TEST(Neighbours, CrowdsAreSeenWhole) {
  auto points = random_points<3>(1500, 7);
  for (std::size_t k = 0; k < 1200; ++k) points[k] *= 0.2;
  expect_all_pairs<3>(points, 0.31);
}

/// Over the searches of a run lists come to hold what they need, not the most that each block ever did.
TEST(Neighbours, ListsGiveBackWhatTheyNoLongerNeed) {
  const auto points = random_points<3>(4000, 8);
  std::vector<std::int32_t> id(points.size());
  std::iota(id.begin(), id.end(), 0);
  std::vector<Vec3> sorted;
  for (const auto i : compute_cell_order<3>(points, id, 0.2)) sorted.push_back(points[i]);
  NeighbourLists reused, fresh;
  build_neighbour_lists<3>(sorted, 0.2, 0.2, 8, reused);
  const std::size_t before = reused.n_bytes();
  build_neighbour_lists<3>(sorted, 0.1, 0.2, 8, reused);
  build_neighbour_lists<3>(sorted, 0.1, 0.2, 8, fresh);
  EXPECT_LT(reused.n_bytes(), before);
  EXPECT_EQ(reused.n_bytes(), fresh.n_bytes());
}

TEST(Neighbours, FarClustersNeedNoDenseGrid) {
  auto points = random_points<3>(100, 4);
  for (int k = 0; k < 50; ++k) points[k] += Vec3(1e5, -1e5, 1e5);
  expect_all_pairs<3>(points, 0.3);
}

TEST(Neighbours, OrderDependsOnPositionsAndIdsOnly) {
  const auto points = random_points<3>(500, 5);
  std::vector<std::int32_t> id(points.size());
  std::iota(id.begin(), id.end(), 0);
  const auto order = compute_cell_order<3>(points, id, 0.4);
  std::vector<std::int32_t> shuffle = id;
  std::shuffle(shuffle.begin(), shuffle.end(), std::mt19937(6));
  std::vector<Vec3> shuffled_points;
  for (const auto i : shuffle) shuffled_points.push_back(points[i]);
  const auto shuffled_order = compute_cell_order<3>(shuffled_points, shuffle, 0.4);
  for (std::size_t k = 0; k < id.size(); ++k) ASSERT_EQ(shuffle[shuffled_order[k]], order[k]);
}

TEST(Neighbours, RefusesWhatNoGridCanHold) {
  std::vector<Vec3> points = {Vec3::Zero(), Vec3(1e12, 0, 0)};
  const std::vector<std::int32_t> id = {0, 1};
  EXPECT_THROW(compute_cell_order<3>(points, id, 1e-3), std::logic_error);
}

}  // namespace
}  // namespace smelt
