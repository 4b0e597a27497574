#include "core/geometry/height_field.h"

#include "core/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace smelt {
namespace {

HeightField make_field(std::size_t columns, std::size_t rows, double cell, double (*height)(double x, double z)) {
  HeightField f{columns, rows, cell, {}};
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < columns; ++c)
      f.height.push_back(height(cell * (static_cast<double>(c) - 0.5 * static_cast<double>(columns - 1)),
                                cell * (static_cast<double>(r) - 0.5 * static_cast<double>(rows - 1))));
  return f;
}

double hills(double x, double z) {
  return 3.0 + std::sin(x) + 0.5 * std::cos(1.3 * z) + 0.2 * x;
}

// The volume under bilinear cells cut along either diagonal is that of the mean of two triangles: here against the sum
// over triangles' corners, which for a solid with vertical walls is exact.
TEST(HeightField, SolidIsClosedAndHoldsTheVolumeUnderItsTriangles) {
  const HeightField f = make_field(9, 6, 0.7, hills);
  const double bottom = 0.5;
  const TriangleMesh sheet = make_terrain_sheet(f), solid = make_terrain_solid(f, bottom);
  double volume = 0.0;
  for (const auto& t : sheet.triangles) {
    double mean = 0.0;
    for (const auto v : t) mean += sheet.vertices[v][1] / 3.0;
    volume += 0.5 * 0.7 * 0.7 * (mean - bottom);
  }
  const MeshTopology topology = compute_topology(solid);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.euler_characteristic, 2);
  EXPECT_NEAR(compute_volume(solid), volume, 1e-12 * volume);
  EXPECT_EQ(sheet.triangles.size(), 2u * 8u * 5u);
  for (const auto& t : sheet.triangles) {
    const Vec3 a = sheet.vertices[t[1]] - sheet.vertices[t[0]], b = sheet.vertices[t[2]] - sheet.vertices[t[0]];
    ASSERT_GT(a[2] * b[0] - a[0] * b[2], 0.0) << "faces up";
  }
}

TEST(HeightField, LiesAroundTheOriginWithItsFirstRowNorth) {
  HeightField f{3, 2, 10.0, {1, 2, 3, 4, 5, 6}};
  const TriangleMesh sheet = make_terrain_sheet(f);
  EXPECT_EQ(sheet.vertices[0], Vec3(-10.0, 1.0, -5.0));
  EXPECT_EQ(sheet.vertices[2], Vec3(10.0, 3.0, -5.0));
  EXPECT_EQ(sheet.vertices[5], Vec3(10.0, 6.0, 5.0));
}

TEST(HeightField, RefiningKeepsTheHeightsAndReproducesQuadratics) {
  const auto bowl = [](double x, double z) { return 0.3 * x * x - 0.2 * z * z + 0.1 * x * z + x - 2.0; };
  const HeightField coarse = make_field(8, 7, 0.5, bowl), fine = refine(coarse, 4);
  ASSERT_EQ(fine.n_columns, 29u);
  ASSERT_EQ(fine.n_rows, 25u);
  EXPECT_DOUBLE_EQ(fine.cell, 0.125);
  for (std::size_t r = 0; r < coarse.n_rows; ++r)
    for (std::size_t c = 0; c < coarse.n_columns; ++c) EXPECT_NEAR(fine.at(4 * c, 4 * r), coarse.at(c, r), 1e-12);
  // Catmull-Rom is exact for quadratics where it has both neighbours.
  const HeightField exact = make_field(29, 25, 0.125, bowl);
  for (std::size_t r = 4; r <= 20; ++r)
    for (std::size_t c = 4; c <= 24; ++c) ASSERT_NEAR(fine.at(c, r), exact.at(c, r), 1e-12);
}

TEST(HeightField, RefusesWhatIsNoTerrain) {
  EXPECT_THROW(make_terrain_sheet({1, 5, 1.0, {1, 2, 3, 4, 5}}), Error);
  EXPECT_THROW(make_terrain_sheet({2, 2, 0.0, {1, 2, 3, 4}}), Error);
  EXPECT_THROW(make_terrain_solid({2, 2, 1.0, {1, 2, 3, 4}}, 1.0), Error);
  try {
    make_terrain_sheet({2, 2, 1.0, {1, 2, 3, std::numeric_limits<double>::quiet_NaN()}});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("row 2, column 2"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace smelt
