// Colliders as people hand them in: wound the wrong way, open, of another unit, where fluid starts.

#include "core/error.h"
#include "core/geometry/orientation.h"
#include "scenes/build_simulation.h"
#include "scenes/scene_reader.h"
#include "tests/meshes.h"

#include <gtest/gtest.h>

#include <fstream>
#include <unistd.h>

namespace smelt {
namespace {

/// A bunny, half a metre to a metre large, and one collider beside or around it.
Scene scene_with(const std::string& mesh, double scale, const Vec3& translate) {
  Scene scene = read_scene(source_folder() / "scenes/melting_bunny.toml", {"particles.count=800"});
  ColliderSettings collider = scene.colliders[0];
  collider.mesh = mesh;
  collider.placement.scale = scale;
  collider.placement.translate = translate;
  scene.colliders = {collider};
  return scene;
}

/// Path of an OBJ file of `mesh`.
std::string write_obj(const std::string& name, const TriangleMesh& mesh) {
  const std::string path = fmt::format("{}smelt_{}_{}", testing::TempDir(), ::getpid(), name);
  std::ofstream file(path);
  for (const Vec3& v : mesh.vertices) file << "v " << v[0] << " " << v[1] << " " << v[2] << "\n";
  for (const auto& t : mesh.triangles) file << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  return path;
}

/// Whether exactly one warning was given, of the collider, with these words in it.
void expect_warning(const SimulationSetup& setup, const std::string& mesh, const std::string& words) {
  ASSERT_EQ(setup.warnings.size(), 1u);
  EXPECT_NE(setup.warnings[0].find(mesh), std::string::npos) << setup.warnings[0];
  EXPECT_NE(setup.warnings[0].find(words), std::string::npos) << setup.warnings[0];
}

TEST(PrepareColliders, InvertedSolidIsTurned) {
  const SimulationSetup setup = build_simulation(scene_with("assets/bad/inverted_box.obj", 1.0, Vec3(5, 0, 0)));
  expect_warning(setup, "inverted_box.obj", "wound inward");
  EXPECT_TRUE(setup.obstacles[0].closed);
  EXPECT_NEAR(compute_volume(setup.colliders[0]), 1.0, 1e-12);
}

TEST(PrepareColliders, AVesselMayBeWoundEitherWay) {
  const std::string outward = write_obj("outward_box.obj", make_box(Vec3::Zero(), Vec3::Ones()));
  for (const std::string& mesh : {std::string("assets/bad/inverted_box.obj"), outward}) {
    const SimulationSetup setup = build_simulation(scene_with(mesh, 4.0, Vec3(-2, -1, -2)));
    EXPECT_FALSE(setup.obstacles[0].closed) << mesh;
    EXPECT_TRUE(setup.warnings.empty()) << setup.warnings[0];
  }
}

TEST(PrepareColliders, FacesAgainstTheirNeighboursAreTurned) {
  const SimulationSetup setup = build_simulation(scene_with("assets/bad/misoriented_box.obj", 1.0, Vec3(5, 0, 0)));
  expect_warning(setup, "misoriented_box.obj", "were wound against their neighbours: turned round");
  EXPECT_TRUE(setup.obstacles[0].closed);
  EXPECT_TRUE(compute_topology(setup.colliders[0]).closed());
}

TEST(PrepareColliders, WhatIsNotQuiteClosedIsASheetAndSaidToBe) {
  TriangleMesh ball = load_asset("sphere.obj");
  ball.triangles.pop_back();
  const SimulationSetup setup = build_simulation(scene_with(write_obj("almost_closed.obj", ball), 1.0, Vec3(5, 0, 0)));
  expect_warning(setup, "almost_closed.obj", "sheet with two sides");
  EXPECT_FALSE(setup.obstacles[0].closed);
  // Open on purpose.
  EXPECT_TRUE(build_simulation(scene_with("assets/bad/open_box.obj", 1.0, Vec3(5, 0, 0))).warnings.empty());
}

TEST(PrepareColliders, ASheetMayBeFlatButNotEmptyOrNaN) {
  EXPECT_TRUE(build_simulation(scene_with("assets/bad/flat.obj", 1.0, Vec3(5, 0, 0))).warnings.empty());
  for (const char* bad : {"assets/bad/empty.obj", "assets/bad/no_faces.obj", "assets/bad/nan.obj",
                          "assets/bad/degenerate.obj", "assets/bad/bad_index.obj"}) {
    const std::string message = message_of<Error>([&] { build_simulation(scene_with(bad, 1.0, Vec3::Zero())); });
    EXPECT_NE(message.find(bad), std::string::npos) << message;
  }
}

// Seen from both sides, as modelling programs export them, and looking down.
TEST(PrepareColliders, ASheetOfDoubledFacesIsOneThatLooksUp) {
  TriangleMesh sheet;
  sheet.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 0, 1), Vec3(0, 0, 1)};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}, {2, 1, 0}, {3, 2, 0}};
  const SimulationSetup setup = build_simulation(scene_with(write_obj("doubled.obj", sheet), 1.0, Vec3(5, 0, 0)));
  expect_warning(setup, "doubled.obj", "2 of the collider's 4 faces lie on others: left out");
  EXPECT_NEAR((compute_vector_area(setup.colliders[0]) - Vec3::UnitY()).norm(), 0.0, 1e-12);
}

// A floor with a wall in its middle, three faces at the edge between them.
TEST(PrepareColliders, ASheetThatBranchesIsSaidTo) {
  TriangleMesh sheet;
  for (const double x : {-1.0, 0.0, 1.0})
    for (const double z : {0.0, 1.0}) sheet.vertices.emplace_back(x, 0.0, z);
  sheet.vertices.emplace_back(0.0, 1.0, 0.0);
  sheet.vertices.emplace_back(0.0, 1.0, 1.0);
  sheet.triangles = {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}, {2, 3, 7}, {2, 7, 6}};
  const SimulationSetup setup = build_simulation(scene_with(write_obj("branches.obj", sheet), 1.0, Vec3(5, 0, 0)));
  expect_warning(setup, "branches.obj", "the collider branches (edges with more than two faces: 1)");
}

TEST(PrepareColliders, SizesThatNoUnitFitsAreNamed) {
  expect_warning(build_simulation(scene_with("assets/bad/open_box.obj", 1000.0, Vec3(50, 0, 0))), "open_box.obj",
                 "enormous, 1e+03 x 1e+03 x 1e+03 m");
  expect_warning(build_simulation(scene_with("assets/bad/open_box.obj", 0.001, Vec3(50, 0, 0))), "open_box.obj",
                 "tiny, 0.001 x 0.001 x 0.001 m");
}

// The bunny's chest is some 0.3 m around this place.
TEST(PrepareColliders, ParticlesInASolidAreLeftOut) {
  const Scene scene = scene_with("assets/bad/inverted_box.obj", 0.2, Vec3(-0.2, 0.25, -0.1));
  const SimulationSetup setup = build_simulation(scene);
  ASSERT_EQ(setup.warnings.size(), 2u);  // it is turned as well
  const std::string& warning = setup.warnings[1];
  EXPECT_NE(warning.find("would start inside this solid collider"), std::string::npos) << warning;
  Scene without = scene;
  without.colliders.clear();
  const SimulationSetup whole = build_simulation(without);
  const std::size_t n = setup.particles.size(), n_whole = whole.particles.size();
  ASSERT_LT(n, n_whole);
  EXPECT_NEAR(static_cast<double>(n_whole - n) * whole.parameters.particle_volume, 0.008, 0.0025);
  // Those that stay are the same ones, as large as before, numbered through.
  EXPECT_NEAR(setup.parameters.particle_volume / whole.parameters.particle_volume, 1.0, 1e-12);
  EXPECT_EQ(setup.particles.velocity.size(), n);
  EXPECT_EQ(setup.particles.temperature.size(), n);
  const TriangleMesh& box = setup.colliders[0];
  const Box3 bounds = compute_bounds(box);
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_EQ(setup.particles.id[i], static_cast<std::int32_t>(i));
    const Vec3& x = setup.particles.position[i];
    EXPECT_FALSE((x.array() > bounds.lower.array()).all() && (x.array() < bounds.upper.array()).all());
  }
}

TEST(PrepareColliders, ABodyHalfOutOfItsVesselIsRefused) {
  const std::string message =
      message_of<Error>([] { build_simulation(scene_with("assets/bad/inverted_box.obj", 4.0, Vec3(-2, 0.15, -2))); });
  EXPECT_NE(message.find("inverted_box.obj"), std::string::npos) << message;
  EXPECT_NE(message.find("bunny.obj"), std::string::npos) << message;
  EXPECT_NE(message.find("a vessel must hold all of a body"), std::string::npos) << message;
}

TEST(PrepareColliders, ASheetThroughABodyIsSaidToCutIt) {
  // A square in one plane, through its middle.
  Scene scene = scene_with("assets/bad/flat.obj", 4.0, Vec3::Zero());
  scene.colliders[0].placement.translate = Vec3(-2.0, 0.4, -2.0);
  const SimulationSetup setup = build_simulation(scene);
  expect_warning(setup, "flat.obj", "cuts through a body");
}

}  // namespace
}  // namespace smelt
