#include "core/geometry/orientation.h"

#include "tests/meshes.h"

#include <gtest/gtest.h>

#include <random>

namespace smelt {
namespace {

/// A sheet of n x n cells in the plane y = 0 that looks up.
TriangleMesh make_sheet(std::uint32_t n) {
  TriangleMesh mesh;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) mesh.vertices.emplace_back(i, 0.0, j);
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t v = j * (n + 1) + i;
      mesh.triangles.push_back({v, v + n + 1, v + 1});
      mesh.triangles.push_back({v + 1, v + n + 1, v + n + 2});
    }
  return mesh;
}

void turn(std::array<std::uint32_t, 3>& triangle) {
  std::swap(triangle[0], triangle[1]);
}

TEST(Orientation, TheFewFollowTheMany) {
  TriangleMesh mesh = make_sheet(20);
  const TriangleMesh whole = mesh;
  std::mt19937 random(7);
  std::size_t n_turned = 0;
  for (auto& t : mesh.triangles)
    if (random() % 4 == 0) turn(t), ++n_turned;
  ASSERT_LT(compute_vector_area(mesh)[1], 300.0);
  const Orientation found = orient(mesh);
  EXPECT_EQ(found.n_turned, n_turned);
  EXPECT_EQ(found.n_dropped, 0u);
  EXPECT_TRUE(found.orientable);
  EXPECT_NEAR((compute_vector_area(mesh) - Vec3(0.0, 400.0, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_EQ(compute_topology(mesh).n_misoriented_edges, 0u);
}

TEST(Orientation, AMeshInOrderStaysAsItIs) {
  TriangleMesh box = make_box(Vec3::Zero(), Vec3::Ones());
  const auto before = box.triangles;
  const Orientation found = orient(box);
  EXPECT_EQ(found.n_turned, 0u);
  EXPECT_EQ(box.triangles, before);
}

// Two sheets apart: each keeps the side that most of it has, and the two need not agree.
TEST(Orientation, EachPartHasASideOfItsOwn) {
  TriangleMesh mesh = make_sheet(3), below = make_sheet(3);
  for (auto& t : below.triangles) turn(t);
  turn(below.triangles[4]);
  const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3& x : below.vertices) mesh.vertices.push_back(x - Vec3(0.0, 5.0, 0.0));
  for (const auto& t : below.triangles) mesh.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  EXPECT_EQ(orient(mesh).n_turned, 1u);
  EXPECT_NEAR(compute_vector_area(mesh).norm(), 0.0, 1e-12);
}

// Modelling programs export sheets seen from both sides as two faces a place.
TEST(Orientation, DoubledFacesAreDropped) {
  TriangleMesh mesh = make_sheet(4);
  const std::size_t n = mesh.triangles.size();
  for (std::size_t f = 0; f < n; ++f) {
    mesh.triangles.push_back(mesh.triangles[f]);
    turn(mesh.triangles.back());
  }
  const Orientation found = orient(mesh);
  EXPECT_EQ(found.n_dropped, n);
  EXPECT_EQ(mesh.triangles.size(), n);
  EXPECT_NEAR(compute_vector_area(mesh)[1], 16.0, 1e-12);
}

TEST(Orientation, AStripWithOneSideIsLeftAlone) {
  TriangleMesh mesh;
  constexpr std::uint32_t n = 12;
  for (std::uint32_t k = 0; k < n; ++k) {
    const double around = 2.0 * M_PI * k / n, turned = M_PI * k / n;
    const Vec3 out(std::cos(around), 0.0, std::sin(around));
    for (const double side : {-0.3, 0.3})
      mesh.vertices.push_back(out + side * (std::cos(turned) * out + std::sin(turned) * Vec3::UnitY()));
  }
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t a = 2 * k, b = 2 * k + 1;
    const std::uint32_t c = k + 1 < n ? a + 2 : 1, e = k + 1 < n ? b + 2 : 0;  // the ends join half a turn round
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({b, e, c});
  }
  const auto before = mesh.triangles;
  EXPECT_FALSE(orient(mesh).orientable);
  EXPECT_EQ(mesh.triangles, before);
}

}  // namespace
}  // namespace smelt
