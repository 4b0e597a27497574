#include "core/geometry/lattice_sites.h"

#include "tests/meshes.h"

#include <random>

namespace smelt {
namespace {

TEST(LatticeSites, DistancesAreThoseToTheNearestOfAllSites) {
  const TriangleMesh bunny = load_asset("bunny.obj");
  const InsideTest inside(bunny, 0.6);
  const Box3 box = inside.bounds();
  const CubicLattice lattice{box.lower + Vec3::Constant(0.3), 0.6,
                             ((box.extent().array() - 0.3) / 0.6).floor().cast<int>() + 1};
  const LatticeSites sites = find_sites_inside(inside, lattice);
  std::vector<Vec3> all;
  for (int k = 0; k < lattice.n_sites.z(); ++k)
    for (const SiteRun& run : sites.layers[static_cast<std::size_t>(k)])
      for (int i = run.first; i < run.last; ++i) all.push_back(lattice.first + lattice.spacing * Vec3(i, run.row, k));
  ASSERT_EQ(static_cast<std::int64_t>(all.size()), count_sites_inside(inside, lattice));

  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.1, 1.1);
  int n_near = 0;
  for (int n = 0; n < 1000; ++n) {
    const Vec3 x = box.lower + box.extent().cwiseProduct(Vec3(uniform(random), uniform(random), uniform(random)));
    double nearest = 1.0;
    for (const Vec3& site : all) nearest = std::min(nearest, (site - x).norm());
    EXPECT_NEAR(sites.distance(x, 1.0), nearest, 1e-12);
    EXPECT_EQ(sites.has_near(x, 0.7), nearest < 0.7);
    n_near += nearest < 1.0;
  }
  EXPECT_GT(n_near, 200);
  EXPECT_LT(n_near, 800);
}

}  // namespace
}  // namespace smelt
