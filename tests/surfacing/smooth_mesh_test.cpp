#include "surfacing/smooth_mesh.h"

#include "surfacing/marching_cubes.h"
#include "tests/surfacing/dense_grid.h"
#include "tests/surfacing/mesh_checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <utility>

namespace smelt {
namespace {

/// Two balls of 6 and 3 cells.
TriangleMesh two_balls() {
  testing::DenseGrid grid = testing::make_grid({32, 16, 16});
  for (int k = 0; k < 16; ++k)
    for (int j = 0; j < 16; ++j)
      for (int i = 0; i < 32; ++i) {
        const double big = 6.0 - (Vec3(i, j, k) - Vec3(7.6, 7.3, 7.5)).norm();
        const double small = 3.0 - (Vec3(i, j, k) - Vec3(22.1, 7.2, 8.4)).norm();
        grid.at(i, j, k) = static_cast<float>(std::max(0.0, 0.5 + 0.1 * std::max(big, small)));
      }
  return extract_iso_surface(testing::make_sparse(grid, {1, 1, 1}), 0.5f);
}

double volume_beyond(const TriangleMesh& mesh, double x) {
  TriangleMesh part = mesh;
  std::erase_if(part.triangles, [&](const auto& t) { return mesh.vertices[t[0]][0] < x; });
  return compute_volume(part);
}

TEST(SmoothMesh, KeepsTheVolumeOfEachPiece) {
  const TriangleMesh mesh = two_balls();
  ASSERT_EQ(compute_topology(mesh).n_components, 2u);
  for (const int passes : {30, 300, 1000}) {  // the small ball would shrink to a point
    TriangleMesh smooth = mesh;
    smooth_mesh(smooth, find_vertex_neighbours(smooth), std::vector<float>(mesh.vertices.size(), 1.0f), passes);
    EXPECT_EQ(testing::find_defect(smooth), "");
    EXPECT_NEAR(compute_volume(smooth) / compute_volume(mesh), 1.0, 1e-3) << passes;
    EXPECT_NEAR(volume_beyond(smooth, 16.0) / volume_beyond(mesh, 16.0), 1.0, 2e-3) << passes;
  }
}

TEST(SmoothMesh, RemovesNoiseAndKeepsTheShape) {
  TriangleMesh mesh = two_balls();
  const Vec3 centre(8.6, 8.3, 8.5);
  // Every vertex of the big ball is pushed in or out by 0.2 cells, in turn.
  const TriangleMesh clean = mesh;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (mesh.vertices[v][0] < 16.0)
      mesh.vertices[v] += (v % 2 == 0 ? 0.2 : -0.2) * (mesh.vertices[v] - centre).normalized();
  smooth_mesh(mesh, find_vertex_neighbours(mesh), std::vector<float>(mesh.vertices.size(), 1.0f), 10);
  double sum = 0.0, n = 0.0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (mesh.vertices[v][0] > 16.0) continue;
    const double error = (mesh.vertices[v] - centre).norm() - 6.0;
    sum += error * error;
    n += 1.0;
  }
  EXPECT_LT(std::sqrt(sum / n), 0.05);
}

/// What `smooth_mesh` is to do, word for word and in double precision, but for the volumes.
std::vector<Vec3> smooth_step_by_step(const TriangleMesh& mesh, std::span<const float> strength, int passes) {
  const VertexNeighbours near = find_vertex_neighbours(mesh);
  const auto smoothed = [&](std::vector<Vec3> x) {
    for (int pass = 0; pass < passes; ++pass) {
      std::vector<Vec3> next = x;
      for (std::size_t v = 0; v < x.size(); ++v) {
        Vec3 sum = Vec3::Zero();
        for (std::uint32_t n = near.begin[v]; n < near.begin[v + 1]; ++n) sum += x[near.neighbour[n]];
        next[v] += 0.8 * strength[v] * (sum / (near.begin[v + 1] - near.begin[v]) - x[v]);
      }
      x = std::move(next);
    }
    return x;
  };
  std::vector<Vec3> once = smoothed(mesh.vertices), lost(once.size());
  for (std::size_t v = 0; v < lost.size(); ++v) lost[v] = mesh.vertices[v] - once[v];
  lost = smoothed(std::move(lost));
  for (std::size_t v = 0; v < lost.size(); ++v) once[v] += lost[v];
  return once;
}

/// A box whose upper face rises on one side and sinks on the other, by a cell, so that flattening it costs no volume,
/// with noise of 0.1 cells; strengths are 1 inside that face and 0 elsewhere.
std::pair<TriangleMesh, std::vector<float>> wavy_box() {
  constexpr double pi = std::numbers::pi;
  testing::DenseGrid grid = testing::make_grid({40, 24, 8}, 1.0f);
  TriangleMesh mesh = extract_iso_surface(testing::make_sparse(grid, {1, 1, 1}), 0.5f);
  std::vector<float> strength(mesh.vertices.size());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> noise(-0.1, 0.1);
  for (std::size_t v = 0; v < strength.size(); ++v) {
    Vec3& x = mesh.vertices[v];
    if (x[2] < 8.2 || x[0] < 3.0 || x[0] > 38.0 || x[1] < 3.0 || x[1] > 22.0) continue;
    strength[v] = 1.0f;
    x += Vec3(noise(random), noise(random), noise(random));
    x[2] += std::sin(2.0 * pi * (x[0] - 3.0) / 35.0) * std::sin(pi * (x[1] - 3.0) / 19.0);
  }
  return {std::move(mesh), std::move(strength)};
}

/// Fewer and unequal steps damp waves of all lengths alike to a few per cent, however many passes they stand for.
TEST(SmoothMesh, ManyPassesDoWhatTheyDoOneByOne) {
  const auto [mesh, strength] = wavy_box();
  for (const int passes : {1, 5, 30, 100, 300, 1000}) {
    TriangleMesh smooth = mesh;
    smooth_mesh(smooth, find_vertex_neighbours(mesh), strength, passes);
    const std::vector<Vec3> exact = smooth_step_by_step(mesh, strength, passes);
    double farthest = 0.0;
    for (std::size_t v = 0; v < exact.size(); ++v)
      farthest = std::max(farthest, (smooth.vertices[v] - exact[v]).norm());
    EXPECT_LT(farthest, passes < 1000 ? 0.1 : 0.02) << passes << " passes";
  }
}

TEST(SmoothMesh, LeavesVerticesOfNoStrengthAndZeroPassesAlone) {
  const TriangleMesh mesh = two_balls();
  TriangleMesh same = mesh;
  smooth_mesh(same, find_vertex_neighbours(same), std::vector<float>(mesh.vertices.size(), 1.0f), 0);
  EXPECT_EQ(same.vertices, mesh.vertices);

  std::vector<float> strength(mesh.vertices.size());
  for (std::size_t v = 0; v < strength.size(); ++v) strength[v] = mesh.vertices[v][0] < 16.0 ? 1.0f : 0.0f;
  smooth_mesh(same, find_vertex_neighbours(same), strength, 30);
  std::size_t moved = 0;
  for (std::size_t v = 0; v < strength.size(); ++v) {
    if (strength[v] == 0.0f) {
      ASSERT_EQ(same.vertices[v], mesh.vertices[v]);
    }
    moved += same.vertices[v] != mesh.vertices[v];
  }
  EXPECT_GT(moved, 100u);
}

TEST(SmoothMesh, NormalsOfABallPointOutward) {
  const TriangleMesh mesh = two_balls();
  const std::vector<Vec3f> normals = compute_vertex_normals(mesh, find_vertex_neighbours(mesh));
  const Vec3 centre(8.6, 8.3, 8.5);
  for (std::size_t v = 0; v < normals.size(); ++v) {
    ASSERT_NEAR(normals[v].norm(), 1.0f, 1e-5f);
    if (mesh.vertices[v][0] < 16.0) {
      ASSERT_GT(normals[v].cast<double>().dot((mesh.vertices[v] - centre).normalized()), 0.95);
    }
  }
}

}  // namespace
}  // namespace smelt
