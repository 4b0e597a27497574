#include "core/geometry/thin_parts.h"

#include "tests/meshes.h"

#include <queue>

namespace smelt {
namespace {

constexpr double spacing = 0.1;

LatticeSites sites_from_corner(const InsideTest& inside) {
  const Box3 box = inside.bounds();
  return find_sites_inside(inside, {box.lower + Vec3::Constant(0.5 * spacing), spacing,
                                    (box.extent().array() / spacing - 0.5).floor().cast<int>() + 1});
}

std::vector<Vec3> fill(const TriangleMesh& mesh) {
  const InsideTest inside(mesh, spacing);
  return fill_thin_parts(mesh, inside, sites_from_corner(inside));
}

TriangleMesh turned(TriangleMesh mesh, double angle) {
  const Mat3 turn = Eigen::AngleAxisd(angle, Vec3(0.3, 0.8, 0.5).normalized()).toRotationMatrix();
  for (Vec3& v : mesh.vertices) v = turn * v;
  return mesh;
}

/// A cube with a fin 0.4 spacings thick, 8 wide and 8 high on top of it, between two layers of sites.
TriangleMesh make_cube_with_fin() {
  return joined(make_box(Vec3::Zero(), Vec3::Constant(1.6)), make_box({0.4, 1.61, 0.78}, {1.2, 2.41, 0.82}));
}

TEST(ThinParts, AFinBetweenTheLayersIsFilled) {
  const TriangleMesh mesh = make_cube_with_fin();
  const InsideTest inside(mesh, spacing);
  const LatticeSites sites = sites_from_corner(inside);
  ASSERT_EQ(count_sites_inside(inside, sites.lattice), 16 * 16 * 16);
  const std::vector<Vec3> seeds = fill_thin_parts(mesh, inside, sites);

  // In the middle of the fin, apart, and no point of it too far from all of them: 1.2 spacings at what is looked at,
  // which is half a spacing apart at most.
  std::vector<Crossing> crossings;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    EXPECT_TRUE(inside.contains(seeds[i], crossings));
    EXPECT_GE(sites.distance(seeds[i], 1.0), 0.85 * spacing);
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE((seeds[i] - seeds[j]).norm(), 0.85 * spacing);
  }
  for (double x = 0.4; x <= 1.2; x += 0.02)
    for (double y = 1.61; y <= 2.41; y += 0.02) {
      double nearest = sites.distance({x, y, 0.82}, 1.0);
      for (const Vec3& seed : seeds) nearest = std::min(nearest, (seed - Vec3(x, y, 0.82)).norm());
      EXPECT_LT(nearest, 1.5 * spacing) << x << ' ' << y;
    }
  // As many as that takes: a square lattice 1.2 spacings wide would have 44.
  EXPECT_GT(seeds.size(), 25u);
  EXPECT_LT(seeds.size(), 50u);

  // All hang together, down to the cube.
  std::vector<bool> reached(seeds.size(), false);
  std::queue<Vec3> front;
  const auto reach = [&](std::size_t i) {
    reached[i] = true;
    front.push(seeds[i]);
  };
  for (std::size_t i = 0; i < seeds.size(); ++i)
    if (sites.has_near(seeds[i], 1.5 * spacing)) reach(i);
  for (; !front.empty(); front.pop())
    for (std::size_t i = 0; i < seeds.size(); ++i)
      if (!reached[i] && (seeds[i] - front.front()).norm() < 1.5 * spacing) reach(i);
  EXPECT_EQ(std::count(reached.begin(), reached.end(), true), static_cast<std::ptrdiff_t>(seeds.size()));
}

TEST(ThinParts, WideBodiesGetNone) {
  // Up to 0.95 spacings lie between the last layer and the wall, 1.65 to a corner.
  for (const double angle : {0.0, 0.4, 1.1, 2.0}) {
    EXPECT_TRUE(fill(turned(make_box(Vec3::Zero(), Vec3::Constant(1.045)), angle)).empty()) << angle;
    EXPECT_TRUE(fill(turned(make_sphere(Vec3::Zero(), 0.6, 4), angle)).empty()) << angle;
  }
}

}  // namespace
}  // namespace smelt
