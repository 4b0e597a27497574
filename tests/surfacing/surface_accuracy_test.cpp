// How true surfaces are to what the particles fill, and how still they stand while it moves.

#include "bench/cases/surfacing.h"
#include "core/geometry/seeding.h"
#include "core/geometry/simplex_bvh.h"
#include "surfacing/surface.h"
#include "tests/meshes.h"
#include "tests/surfacing/mesh_checks.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace smelt {
namespace {

using namespace surfacing_cases;

double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

/// Triangles to be asked for what is nearest.
class Nearest {
 public:
  explicit Nearest(const TriangleMesh& mesh) : mesh_(mesh), bvh_(simplices(mesh)) {}

  /// The nearest vertex of the triangles within `radius`, which must have one.
  std::uint32_t vertex(const Vec3& x, double radius) const {
    std::vector<std::uint32_t> found;
    bvh_.find_near(x, radius, found);
    EXPECT_FALSE(found.empty());
    std::uint32_t best = 0;
    double least = 1e300;
    for (const std::uint32_t t : found)
      for (const std::uint32_t v : mesh_.triangles[t])
        if (const double d = (mesh_.vertices[v] - x).squaredNorm(); d < least) {
          least = d;
          best = v;
        }
    return best;
  }

 private:
  const TriangleMesh& mesh_;
  SimplexBvh<3> bvh_;
};

class SurfaceAccuracy : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Kernels, SurfaceAccuracy, ::testing::Bool(),
                         [](const auto& p) { return p.param ? "Anisotropic" : "Isotropic"; });

/// Bars: radius 1 %, volume 0.5 %, normals 3 degrees RMS. An isotropic kernel draws a ball of radius r in by 0.3 h^2/r,
/// 0.5 % of the volume at this size, and keeps a bar of 1 %.
TEST_P(SurfaceAccuracy, ABallOfTenThousandParticles) {
  const double spacing = 0.02, radius = spacing * std::cbrt(3.0 * 10000.0 / (4.0 * std::numbers::pi));
  for (const double shaken : {0.0, 0.1, 0.2}) {
    ParticleFrame frame = make_ball(radius, spacing);
    jitter(frame, shaken);
    const SurfaceMesh surface = build_surface(frame, with_kernels(GetParam()));
    ASSERT_EQ(testing::find_defect(surface.mesh), "");
    ASSERT_EQ(compute_topology(surface.mesh).euler_characteristic, 2);
    const BallErrors errors = measure_ball(surface, frame, radius);
    std::printf("shaken by %.1f: mean radius %+.2f %%, farthest %.2f %%, volume %+.2f %%, normals %.2f degrees\n",
                shaken, 100.0 * errors.mean_radius, 100.0 * errors.farthest, 100.0 * errors.volume,
                degrees(errors.normals));
    EXPECT_NEAR(errors.mean_radius, 0.0, 0.01);
    EXPECT_NEAR(errors.volume, 0.0, GetParam() ? 0.005 : 0.01);
    EXPECT_LT(degrees(errors.normals), 3.0);
  }
}

/// Bars for all of the mesh, both ways: Hausdorff's distance 1 spacing, means 0.25, volume 1 %.
TEST_P(SurfaceAccuracy, TheBunnyFromItsOwnParticles) {
  const TriangleMesh bunny = load_asset("bunny.obj");
  SeedingOptions seeding;
  seeding.count = 10188;
  const Seeds seeds = seed_particles(bunny, seeding);
  const double spacing = seeds.spacing;  // n spacing^3 is the volume
  const SurfaceMesh surface = build_surface(make_frame(seeds.positions, spacing), with_kernels(GetParam()));
  ASSERT_EQ(testing::find_defect(surface.mesh), "");
  const Distances there = distances(surface.mesh, bunny, 4.0 * spacing),
                  back = distances(bunny, surface.mesh, 4.0 * spacing);
  const double volume = compute_volume(surface.mesh) / compute_volume(bunny);
  std::printf(
      "%zu seeds in thin parts; to the mesh: largest %.2f spacings, mean %.3f; from it: largest %.2f, mean %.3f; "
      "volume %+.2f %%\n",
      seeds.n_in_thin_parts, there.largest / spacing, there.mean / spacing, back.largest / spacing, back.mean / spacing,
      100.0 * (volume - 1.0));
  EXPECT_LT(std::max(there.largest, back.largest), spacing);
  EXPECT_LT(std::max(there.mean, back.mean), 0.25 * spacing);
  EXPECT_NEAR(volume, 1.0, 0.01);
}

/// A shaken ball of 4000 particles turns by a degree a frame: what its normals do beyond turning along is flicker.
TEST_P(SurfaceAccuracy, NormalsStandStillWhileABodyTurns) {
  const double spacing = 0.02, radius = 10.0 * spacing;
  ParticleFrame frame = make_ball(radius, spacing);
  jitter(frame, 0.2);
  const Eigen::AngleAxisd turn(std::numbers::pi / 180.0, Vec3(0.3, 0.9, -0.2).normalized());
  const std::vector<Vec3> at_rest = frame.position;
  Mat3 turned = Mat3::Identity();
  SurfaceMesh before = build_surface(frame, with_kernels(GetParam()));
  double angle = 0.0, n = 0.0;
  for (int step = 0; step < 6; ++step) {
    turned = turn.toRotationMatrix() * turned;
    for (std::size_t i = 0; i < at_rest.size(); ++i) frame.position[i] = turned * at_rest[i];
    SurfaceMesh now = build_surface(frame, with_kernels(GetParam()));
    const Nearest nearest(now.mesh);
    for (std::size_t v = 0; v < before.normals.size(); ++v) {
      const Vec3 x = turn * before.mesh.vertices[v];
      const std::uint32_t w = nearest.vertex(x, spacing);
      // The ball's own turn of the normal from x to the vertex is no flicker.
      const Vec3 along =
          Eigen::Quaterniond::FromTwoVectors(x, now.mesh.vertices[w]) * (turn * before.normals[v].cast<double>());
      angle += std::pow(std::acos(std::clamp(along.dot(now.normals[w].cast<double>()), -1.0, 1.0)), 2);
      n += 1.0;
    }
    before = std::move(now);
  }
  std::printf("normals of one frame to the next: %.2f degrees RMS\n", degrees(std::sqrt(angle / n)));
  EXPECT_LT(degrees(std::sqrt(angle / n)), 1.0);
}

}  // namespace
}  // namespace smelt
