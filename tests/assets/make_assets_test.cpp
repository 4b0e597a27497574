// The meshes of our own making: whole, of the topology they are to have, and what assets/ holds.

#include "io/obj.h"
#include "tests/source_folder.h"
#include "tests/surfacing/mesh_checks.h"

#include <gtest/gtest.h>

#include "assets/chair.h"
#include "assets/extruded_text.h"
#include "assets/hand.h"
#include <filesystem>

namespace smelt {
namespace {

/// As the mesh of assets/, made by the same call: the same triangles, the same volume to the digits of the file.
void expect_like_file(const TriangleMesh& mesh, const std::string& name) {
  const TriangleMesh file = read_obj(source_folder() / "assets" / name).mesh;
  EXPECT_EQ(mesh.triangles.size(), file.triangles.size()) << name;
  EXPECT_NEAR(compute_volume(mesh) / compute_volume(file), 1.0, 1e-4) << name;
}

TEST(MakeAssets, TheChairIsOnePieceOfGenusThree) {
  const TriangleMesh mesh = make_chair(0.45);
  EXPECT_EQ(testing::find_defect(mesh), "");
  const MeshTopology topology = compute_topology(mesh);
  EXPECT_EQ(topology.n_components, 1u);
  EXPECT_EQ(topology.euler_characteristic, 2 - 2 * 3) << "six arms between four lobes";
  expect_like_file(mesh, "chair.obj");
}

TEST(MakeAssets, TheHandIsOnePieceThatStandsUpright) {
  const TriangleMesh mesh = make_hand(0.012);
  EXPECT_EQ(testing::find_defect(mesh), "");
  EXPECT_EQ(compute_topology(mesh).n_components, 1u);
  Box3 box;
  for (const Vec3& x : mesh.vertices) box.extend(x);
  EXPECT_NEAR(box.lower[1], -0.004, 1e-3);
  EXPECT_NEAR(box.upper[1], 1.177, 1e-3);
  expect_like_file(mesh, "hand.obj");
}

TEST(MakeAssets, LettersAreAPieceEachWithTheirHoles) {
  const std::filesystem::path font = "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf";
  if (!std::filesystem::exists(font)) GTEST_SKIP() << "needs fonts-dejavu-core";
  const TriangleMesh mesh = make_extruded_text(font, "CGF 2007", 0.26, 0.03);
  EXPECT_EQ(testing::find_defect(mesh), "");
  const MeshTopology topology = compute_topology(mesh);
  EXPECT_EQ(topology.n_components, 7u);
  EXPECT_EQ(topology.euler_characteristic, 5 * 2 + 2 * 0) << "a hole in either 0";
  expect_like_file(mesh, "letters.obj");
}

}  // namespace
}  // namespace smelt
