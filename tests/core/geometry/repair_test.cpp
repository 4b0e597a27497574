#include "core/geometry/repair.h"

#include "core/error.h"
#include "core/geometry/inside.h"
#include "tests/meshes.h"

#include <limits>

namespace smelt {
namespace {

void expect_sound(const TriangleMesh& mesh) {
  EXPECT_TRUE(compute_topology(mesh).closed());
  EXPECT_GT(compute_volume(mesh), 0.0);
}

std::string refusal(const TriangleMesh& mesh) {
  return message_of<Error>([&] { repair(mesh, 0.1); });
}

TEST(Repair, LeavesASoundMeshAlone) {
  const TriangleMesh bunny = load_asset("bunny.obj");
  const RepairedMesh result = repair(bunny, 0.27);
  EXPECT_FALSE(result.report.repaired);
  EXPECT_EQ(result.mesh.vertices, bunny.vertices);
  EXPECT_EQ(result.mesh.triangles, bunny.triangles);
  EXPECT_NE(result.report.description.find("closed, 3674 faces"), std::string::npos) << result.report.description;
}

TEST(Repair, KeepsACavity) {
  const TriangleMesh hollow = joined(make_box(Vec3::Zero(), Vec3::Constant(3.0)),
                                     turned_inside_out(make_box(Vec3::Ones(), Vec3::Constant(2.0))));
  const RepairedMesh result = repair(hollow, 0.1);
  EXPECT_FALSE(result.report.repaired);
  EXPECT_NEAR(compute_volume(result.mesh), 26.0, 1e-12);
}

TEST(Repair, TurnsFacesOutward) {
  const RepairedMesh box = repair(load_asset("bad/inverted_box.obj"), 0.1);
  EXPECT_TRUE(box.report.repaired);
  EXPECT_NE(box.report.description.find("wound inward"), std::string::npos) << box.report.description;
  EXPECT_DOUBLE_EQ(compute_volume(box.mesh), 1.0);
  // One of two parts.
  const TriangleMesh parts = joined(make_box(Vec3::Zero(), Vec3::Ones()),
                                    turned_inside_out(make_box(Vec3::Constant(2.0), Vec3::Constant(3.0))));
  EXPECT_DOUBLE_EQ(compute_volume(repair(parts, 0.1).mesh), 2.0);
  // One face among others.
  const RepairedMesh one = repair(load_asset("bad/misoriented_box.obj"), 0.1);
  EXPECT_EQ(one.report.description.find("3 misoriented edges: faces turned"), 0u) << one.report.description;
  expect_sound(one.mesh);
  EXPECT_DOUBLE_EQ(compute_volume(one.mesh), 1.0);
}

TEST(Repair, FillsHolesWithoutMovingTheRest) {
  const RepairedMesh box = repair(load_asset("bad/open_box.obj"), 0.1);
  EXPECT_EQ(box.report.description.find("4 boundary edges: 1 hole filled with 2 faces"), 0u) << box.report.description;
  expect_sound(box.mesh);
  EXPECT_DOUBLE_EQ(compute_volume(box.mesh), 1.0);

  TriangleMesh bunny = load_asset("bunny.obj");
  bunny.triangles.erase(bunny.triangles.begin(), bunny.triangles.begin() + 20);
  const RepairedMesh result = repair(bunny, 0.27);
  expect_sound(result.mesh);
  EXPECT_NE(result.report.description.find("2 holes filled with 20 faces"), std::string::npos)
      << result.report.description;
  EXPECT_NEAR(compute_volume(result.mesh) / 194.288, 1.0, 1e-3);
}

TEST(Repair, WrapsATatteredBunnyToAFewPercent) {
  TriangleMesh bunny = load_asset("bunny.obj");
  bunny.triangles.erase(bunny.triangles.begin(), bunny.triangles.begin() + 400);
  const RepairedMesh result = repair(bunny, 0.54);
  expect_sound(result.mesh);
  EXPECT_NE(result.report.description.find("wrapped"), std::string::npos) << result.report.description;
  EXPECT_NEAR(compute_volume(result.mesh) / 194.288, 1.0, 0.05);
}

TEST(Repair, WrapsOverlappingPartsIntoTheirUnion) {
  const RepairedMesh result = repair(load_asset("bad/self_intersecting.obj"), 0.05);
  EXPECT_TRUE(result.report.self_intersects);
  EXPECT_NE(result.report.description.find("18 self-intersecting face pairs"), std::string::npos)
      << result.report.description;
  expect_sound(result.mesh);
  EXPECT_FALSE(repair(result.mesh, 0.05).report.repaired);
  EXPECT_NEAR(compute_volume(result.mesh) / 1.875, 1.0, 0.03);
}

TEST(Repair, ClosesANonManifoldMesh) {
  const RepairedMesh result = repair(load_asset("bad/nonmanifold_box.obj"), 0.1);
  EXPECT_EQ(result.report.description.find("2 boundary edges, 1 non-manifold edge"), 0u) << result.report.description;
  expect_sound(result.mesh);
  EXPECT_NEAR(compute_volume(result.mesh), 1.0, 0.05);
}

TEST(Repair, TakesPartsThatTouchAlongAnEdgeApart) {
  // Two cubes with an edge in common: four faces meet there, but nothing overlaps.
  const TriangleMesh cubes = weld(joined(make_box(Vec3::Zero(), Vec3::Ones()), make_box({1, 1, 0}, {2, 2, 1})), 1e-9);
  ASSERT_EQ(compute_topology(cubes).n_nonmanifold_edges, 1u);
  const RepairedMesh result = repair(cubes, 0.1);
  EXPECT_EQ(result.report.n_self_intersections, 0u);
  expect_sound(result.mesh);
  EXPECT_DOUBLE_EQ(compute_volume(result.mesh), 2.0);
}

TEST(Repair, BridgesAGapWiderThanTwoSpacings) {
  // A fin keeps this one from being filled alone, and the open lid is ten spacings wide.
  TriangleMesh box = subdivide(subdivide(load_asset("bad/open_box.obj")));
  const auto n = static_cast<std::uint32_t>(box.vertices.size());
  box.vertices.emplace_back(-0.2, -0.2, 0.0);
  box.triangles.push_back({box.triangles[0][0], box.triangles[0][1], n});
  const RepairedMesh result = repair(box, 0.1);
  expect_sound(result.mesh);
  EXPECT_NEAR(compute_volume(result.mesh), 1.0, 0.08);
  std::vector<Crossing> crossings;
  EXPECT_TRUE(InsideTest(result.mesh, 0.1).contains(Vec3::Constant(0.5), crossings)) << "the wrap is a shell";
}

TEST(Repair, RefusesWhatBoundsNoBody) {
  EXPECT_NE(refusal({}).find("no triangles"), std::string::npos);
  EXPECT_NE(refusal(load_asset("bad/no_faces.obj")).find("no triangles (8 vertices)"), std::string::npos);
  EXPECT_NE(refusal(load_asset("bad/flat.obj")).find("flat"), std::string::npos);
  EXPECT_NE(refusal(load_asset("bad/degenerate.obj")).find("no area"), std::string::npos);
  EXPECT_NE(refusal(load_asset("bad/folded.obj")).find("bounds no volume"), std::string::npos);
  EXPECT_NE(refusal(load_asset("bad/bad_index.obj")).find("face 12 of the mesh refers to vertex 99; there are 8"),
            std::string::npos);
  TriangleMesh box = make_box(Vec3::Zero(), Vec3::Ones());
  box.vertices[4].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal(box).find("vertex 5 of the mesh is (0, nan, 1)"), std::string::npos);
}

}  // namespace
}  // namespace smelt
