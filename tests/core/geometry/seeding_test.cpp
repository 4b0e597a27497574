#include "core/geometry/seeding.h"

#include "core/error.h"
#include "core/geometry/inside.h"
#include "tests/meshes.h"

#include <tbb/global_control.h>

#include <limits>

namespace smelt {
namespace {

Seeds seed_count(const TriangleMesh& mesh, std::int64_t count) {
  SeedingOptions options;
  options.count = count;
  return seed_particles(mesh, options);
}

Seeds seed_spacing(const TriangleMesh& mesh, double spacing) {
  SeedingOptions options;
  options.spacing = spacing;
  return seed_particles(mesh, options);
}

double lattice_volume(const Seeds& seeds) {
  return static_cast<double>(seeds.positions.size() - seeds.n_in_thin_parts) * std::pow(seeds.lattice_spacing, 3);
}

TEST(Seeding, MeetsTheCountOnTheBunny) {
  const TriangleMesh bunny = load_asset("bunny.obj");
  for (const std::int64_t count : {500, 10188, 100000}) {
    const Seeds seeds = seed_count(bunny, count);
    EXPECT_EQ(seeds.positions.size(), static_cast<std::size_t>(count));
    EXPECT_DOUBLE_EQ(seeds.volume, compute_volume(bunny));
    // The mass is exact by the choice of the spacing; the lattice itself fills the body to a part of a percent.
    EXPECT_NEAR(static_cast<double>(count) * std::pow(seeds.spacing, 3) / seeds.volume, 1.0, 1e-12);
    EXPECT_NEAR(lattice_volume(seeds) / seeds.volume, 1.0, count > 5000 ? 1e-3 : 4e-2) << count;
  }
}

TEST(Seeding, HoldsEverySiteInsideAndNoneOutside) {
  const TriangleMesh bunny = load_asset("bunny.obj");
  const Seeds seeds = seed_spacing(bunny, 0.6);
  const InsideTest inside(bunny, 0.6);
  const Box3 box = compute_bounds(bunny);
  std::vector<Crossing> crossings;
  std::size_t n = 0;
  for (double z = box.lower.z() + 0.3; z < box.upper.z(); z += 0.6)
    for (double y = box.lower.y() + 0.3; y < box.upper.y(); y += 0.6)
      for (double x = box.lower.x() + 0.3; x < box.upper.x(); x += 0.6) {
        if (!inside.contains({x, y, z}, crossings)) continue;
        ASSERT_LT(n, seeds.positions.size());
        EXPECT_LT((seeds.positions[n] - Vec3(x, y, z)).norm(), 1e-9) << "out of order or place: " << n;
        ++n;
      }
  EXPECT_EQ(n + seeds.n_in_thin_parts, seeds.positions.size());
}

TEST(Seeding, FillsABoxExactly) {
  const Seeds seeds = seed_spacing(make_box({-1, 0, 2}, {1, 1, 3}), 0.1);
  EXPECT_EQ(seeds.positions.size(), 2000u);
  EXPECT_NEAR(seeds.spacing, 0.1, 1e-12);
  Box3 box;
  for (const Vec3& x : seeds.positions) box.extend(x);
  EXPECT_LT((box.lower - Vec3(-0.95, 0.05, 2.05)).norm(), 1e-12);
  EXPECT_LT((box.upper - Vec3(0.95, 0.95, 2.95)).norm(), 1e-12);
}

TEST(Seeding, TakesTheNearestCountThatABoxCanHold) {
  const TriangleMesh box = make_box(Vec3::Zero(), Vec3::Ones());
  EXPECT_EQ(seed_count(box, 1000).positions.size(), 1000u);
  // Between 21^3 and 22^3 the lattice must sit differently along different axes.
  const Seeds seeds = seed_count(box, 10188);
  EXPECT_NEAR(static_cast<double>(seeds.positions.size()), 10188.0, 102.0);
  EXPECT_NEAR(lattice_volume(seeds), 1.0, 0.1);
  const std::string message = message_of<Error>([&] { seed_count(box, 10); });
  EXPECT_NE(message.find("10 particles"), std::string::npos) << message;
  EXPECT_NE(message.find("nearest holds"), std::string::npos) << message;
}

TEST(Seeding, JitterIsDeterministicBoundedAndStaysInside) {
  const TriangleMesh bunny = load_asset("bunny.obj");
  SeedingOptions options;
  options.count = 3000;
  const Seeds lattice = seed_particles(bunny, options);
  options.jitter = 0.3;
  options.seed = 5;
  const Seeds jittered = seed_particles(bunny, options), again = seed_particles(bunny, options);
  EXPECT_EQ(jittered.positions, again.positions);
  ASSERT_EQ(jittered.positions.size(), lattice.positions.size());
  const InsideTest inside(bunny, 0.5);
  std::vector<Crossing> crossings;
  Vec3 mean = Vec3::Zero();
  std::size_t n_kept = 0;
  for (std::size_t i = 0; i < jittered.positions.size(); ++i) {
    const Vec3 shift = (jittered.positions[i] - lattice.positions[i]) / lattice.lattice_spacing;
    EXPECT_LE(shift.cwiseAbs().maxCoeff(), 0.3 + 1e-12);
    EXPECT_TRUE(inside.contains(jittered.positions[i], crossings));
    n_kept += shift.norm() == 0.0;
    mean += shift / 3000.0;
  }
  EXPECT_LT(mean.norm(), 0.02);  // Standard deviation of the mean: 0.3/sqrt(3)/sqrt(3000) = 0.003 an axis.
  EXPECT_GT(n_kept, 0u);
  EXPECT_LT(n_kept, 900u);
  options.seed = 6;
  EXPECT_NE(seed_particles(bunny, options).positions, jittered.positions);
}

TEST(Seeding, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh bunny = load_asset("bunny.obj");
  SeedingOptions options;
  options.count = 20000;
  options.jitter = 0.2;
  std::vector<std::vector<Vec3>> results;
  for (const std::size_t n_threads : {1, 2, 4}) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, n_threads);
    results.push_back(seed_particles(bunny, options).positions);
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST(Seeding, RefusesABodyThinnerThanTheLatticeAndSaysWhichSpacingWouldDo) {
  const TriangleMesh plate = make_box(Vec3::Zero(), {1.0, 0.02, 1.0});
  const std::string message = message_of<Error>([&] { seed_spacing(plate, 0.1); });
  EXPECT_NE(message.find("too thin"), std::string::npos) << message;
  // Follow the advice.
  const std::size_t at = message.find("a spacing of ");
  ASSERT_NE(at, std::string::npos) << message;
  const Seeds seeds = seed_spacing(plate, std::stod(message.substr(at + 13)));
  EXPECT_NEAR(lattice_volume(seeds) / seeds.volume, 1.0, 0.2);
}

TEST(Seeding, RefusesBadOptionsAndMeshes) {
  const TriangleMesh box = make_box(Vec3::Zero(), Vec3::Ones());
  const auto refuses = [&](const TriangleMesh& mesh, SeedingOptions options, const std::string& why) {
    const std::string message = message_of<Error>([&] { seed_particles(mesh, options); });
    EXPECT_NE(message.find(why), std::string::npos) << message;
  };
  refuses(box, {0, 0.0, 0.0, 0}, "give one of them");
  refuses(box, {10, 0.1, 0.0, 0}, "give one of them");
  refuses(box, {-5, 0.0, 0.0, 0}, "give one of them");
  refuses(box, {0, std::numeric_limits<double>::quiet_NaN(), 0.0, 0}, "give one of them");
  refuses(box, {0, 0.1, 0.5, 0}, "jitter");
  refuses(box, {0, 1e-6, 0.0, 0}, "sites along one axis");
  refuses(turned_inside_out(box), {0, 0.1, 0.0, 0}, "wound outward");
  refuses(load_asset("bad/open_box.obj"), {0, 0.1, 0.0, 0}, "4 boundary");
}

}  // namespace
}  // namespace smelt
