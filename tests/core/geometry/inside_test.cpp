#include "core/geometry/inside.h"

#include "tests/meshes.h"

#include <random>

namespace smelt {
namespace {

TEST(Inside, AgreesWithTheWindingNumberOnTheBunny) {
  const TriangleMesh bunny = load_asset("bunny.obj");
  const InsideTest inside(bunny, 0.1);
  const Box3 box = compute_bounds(bunny);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-0.05, 1.05);
  std::vector<Crossing> crossings;
  int n_inside = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 p = box.lower + box.extent().cwiseProduct(Vec3(uniform(random), uniform(random), uniform(random)));
    const bool expected = std::abs(winding_number(bunny, p)) > 0.5;
    EXPECT_EQ(inside.contains(p, crossings), expected) << p.transpose();
    n_inside += expected;
  }
  EXPECT_GT(n_inside, 300);
  EXPECT_LT(n_inside, 1700);
}

TEST(Inside, LinesThroughVerticesAndEdgesCrossOnce) {
  // Every line of this lattice runs along faces, edges or through vertices of the subdivided box.
  const TriangleMesh box = subdivide(subdivide(make_box(Vec3::Zero(), Vec3::Ones())));
  const InsideTest inside(box, 0.25);
  std::vector<Crossing> crossings;
  int n_crossed = 0;
  for (int j = 0; j <= 4; ++j)
    for (int k = 0; k <= 4; ++k) {
      inside.intersect(0.25 * j, 0.25 * k, crossings);
      if (crossings.empty()) continue;
      ++n_crossed;
      ASSERT_EQ(crossings.size(), 2u) << j << ' ' << k;
      EXPECT_EQ(crossings[0].x, 0.0);
      EXPECT_EQ(crossings[0].winding, 1);
      EXPECT_EQ(crossings[1].x, 1.0);
      EXPECT_EQ(crossings[1].winding, -1);
    }
  EXPECT_EQ(n_crossed, 16);  // A line on a face belongs to one side of it: 4 x 4 of 5 x 5.
}

TEST(Inside, CavitiesAreOutsideAndOverlapsInside) {
  const TriangleMesh outer = make_box(Vec3::Zero(), Vec3::Constant(3.0));
  const TriangleMesh inner = make_box(Vec3::Ones(), Vec3::Constant(2.0));
  const Vec3 centre(1.5, 1.4, 1.3);
  std::vector<Crossing> crossings;
  const TriangleMesh hollow = joined(outer, turned_inside_out(inner)), overlapping = joined(outer, inner);
  EXPECT_FALSE(InsideTest(hollow, 0.1).contains(centre, crossings));
  EXPECT_TRUE(InsideTest(hollow, 0.1).contains({0.5, 1.4, 1.3}, crossings));
  EXPECT_TRUE(InsideTest(overlapping, 0.1).contains(centre, crossings));
}

}  // namespace
}  // namespace smelt
