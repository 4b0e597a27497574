#include "core/geometry/triangle_mesh.h"

#include "tests/meshes.h"

#include <numbers>

namespace smelt {
namespace {

TEST(TriangleMesh, VolumeAndAreaOfABox) {
  const TriangleMesh box = make_box({1, 2, 3}, {2, 4, 6});
  EXPECT_NEAR(compute_volume(box), 6.0, 1e-14);
  EXPECT_NEAR(compute_area(box), 22.0, 1e-14);
  EXPECT_NEAR(compute_volume(turned_inside_out(box)), -6.0, 1e-14);
}

TEST(TriangleMesh, VolumeSurvivesDistanceFromTheOrigin) {
  const TriangleMesh box = make_box(Vec3::Constant(1e6), Vec3::Constant(1e6 + 1e-2));
  EXPECT_NEAR(compute_volume(box) / 1e-6, 1.0, 1e-7);
}

TEST(TriangleMesh, VolumeOfASphereConvergesAtSecondOrder) {
  const double exact = 4.0 / 3.0 * std::numbers::pi;
  const double coarse = exact - compute_volume(make_sphere(Vec3::Zero(), 1.0, 3));
  const double fine = exact - compute_volume(make_sphere(Vec3::Zero(), 1.0, 4));
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.1);
}

TEST(TriangleMesh, BunnyIsClosedAndHasItsKnownVolume) {
  const TriangleMesh bunny = load_asset("bunny.obj");
  EXPECT_EQ(bunny.vertices.size(), 1839u);
  EXPECT_EQ(bunny.triangles.size(), 3674u);
  EXPECT_NEAR(compute_volume(bunny), 194.288, 1e-3);
  const MeshTopology topology = compute_topology(bunny);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.n_components, 1u);
  EXPECT_EQ(topology.euler_characteristic, 2);
  EXPECT_NEAR(compute_bounds(bunny).extent().y(), 9.66, 0.01);
}

TEST(TriangleMesh, TopologyCountsEachFault) {
  EXPECT_EQ(compute_topology(load_asset("bad/open_box.obj")).n_boundary_edges, 4u);
  EXPECT_EQ(compute_topology(load_asset("bad/misoriented_box.obj")).n_misoriented_edges, 3u);
  const MeshTopology fin = compute_topology(load_asset("bad/nonmanifold_box.obj"));
  EXPECT_EQ(fin.n_nonmanifold_edges, 1u);
  EXPECT_EQ(fin.n_boundary_edges, 2u);
  TriangleMesh box = make_box(Vec3::Zero(), Vec3::Ones());
  box.triangles.push_back({1, 1, 2});
  EXPECT_EQ(compute_topology(box).n_degenerate_faces, 1u);
  EXPECT_FALSE(compute_topology(box).closed());
}

TEST(TriangleMesh, TopologyCountsComponentsAndIgnoresUnusedVertices) {
  TriangleMesh two = joined(make_box(Vec3::Zero(), Vec3::Ones()), make_box(Vec3::Constant(2.0), Vec3::Constant(3.0)));
  two.vertices.push_back(Vec3::Zero());
  const MeshTopology topology = compute_topology(two);
  EXPECT_EQ(topology.n_components, 2u);
  EXPECT_EQ(topology.euler_characteristic, 4);
}

TEST(TriangleMesh, WeldClosesABoxOfLooseFaces) {
  // Each face with corners of its own, moved about by less than the tolerance, around a cell boundary of the search
  // grid.
  const TriangleMesh box = make_box(Vec3::Zero(), Vec3::Ones());
  TriangleMesh loose;
  for (const auto& t : box.triangles) {
    for (const std::uint32_t v : t) {
      const double shift = 4e-4 * std::sin(static_cast<double>(loose.vertices.size()));
      loose.vertices.push_back(box.vertices[v] + Vec3::Constant(shift));
    }
    const auto n = static_cast<std::uint32_t>(loose.vertices.size());
    loose.triangles.push_back({n - 3, n - 2, n - 1});
  }
  EXPECT_EQ(compute_topology(weld(loose, 0.0)).n_components, 12u);
  const TriangleMesh welded = weld(loose, 2e-3);
  EXPECT_EQ(welded.vertices.size(), 8u);
  EXPECT_TRUE(compute_topology(welded).closed());
}

TEST(TriangleMesh, WeldDropsDuplicateAndCollapsedFacesAndUnusedVertices) {
  TriangleMesh mesh;
  mesh.vertices = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}};
  mesh.triangles = {{1, 2, 3}, {2, 3, 1}, {3, 4, 2}, {1, 4, 2}, {1, 3, 2}};
  const TriangleMesh welded = weld(mesh, 0.0);
  EXPECT_EQ(welded.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  // The same face given three times stays once; turned over it is another face; the last but one has lost a corner.
  EXPECT_EQ(welded.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 1}}));
}

}  // namespace
}  // namespace smelt
