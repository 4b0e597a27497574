// Vents, outflow, gates and terrains as scenes state them.
#include "core/error.h"
#include "scenes/build_simulation.h"
#include "scenes/build_view.h"
#include "scenes/check_scene.h"
#include "scenes/scene_reader.h"
#include "scenes/scene_writer.h"
#include "tests/meshes.h"
#include "tests/source_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace smelt {
namespace {

const char* const lava = R"(
[shot]
name = "lava"
frames = 11
fps = 10

[particles]
spacing_m = 2.0

[solver]
sound_speed_m_s = 60.0

[[material]]
name = "lava"
density_kg_m3 = 2600
viscosity = { law = "smd", yield_stress_Pa = 2e3, consistency_Pa_sn = 2e4, index = 1.0, jump_number = 100.0 }
heat = { diffusivity_m2_s = 1e-6, cold_K = 900.0, hot_K = 1400.0 }

[[collider]]
mesh = "assets/maunga_whau.asc"
temperature_K = 300.0

[[emitter]]
material = "lava"
position_m = [-240.0, 197.0, 0.0]
direction = [0.0, 1.0, 0.0]
radius_m = 6.0
flow_rate_m3_s = 500.0
temperature_K = 1400.0
end_s = 0.6

[[outflow]]
removes = "outside"
lower_m = [-420.0, 0.0, -290.0]
upper_m = [420.0, 400.0, 290.0]
)";

std::filesystem::path scene_file() {
  const auto folder = std::filesystem::path(testing::TempDir()) / ("emitter_scene_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const auto path = folder / "lava.toml";
  std::ofstream(path) << lava;
  return path;
}

Scene lava_scene(const std::vector<std::string>& overrides = {}) {
  return read_scene(scene_file(), overrides);
}

std::string error_of(const std::vector<std::string>& overrides) {
  try {
    build_simulation(lava_scene(overrides));
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

TEST(EmitterScene, BuildsWithoutABody) {
  const SimulationSetup setup = build_simulation(lava_scene());
  EXPECT_EQ(setup.particles.size(), 0u);
  EXPECT_DOUBLE_EQ(setup.parameters.particle_volume, 8.0);
  ASSERT_EQ(setup.parameters.emitters.size(), 1u);
  EXPECT_EQ(setup.parameters.emitters[0].end, 0.6);
  EXPECT_DOUBLE_EQ(count_poured(setup, 1.0), 0.6 * 500.0 / 8.0);
  EXPECT_TRUE(setup.obstacles[0].closed) << "the terrain is a solid";
  EXPECT_TRUE(setup.parameters.outflows[0].outside);
}

TEST(EmitterScene, TextAsRunReadsBackTheSame) {
  const Scene scene = lava_scene({"collider.0.until_s=3.5", "collider.0.terrain.refine=2"});
  const std::string text = write_scene(scene);
  const auto path = scene_file().parent_path() / "again.toml";
  std::ofstream(path) << text;
  EXPECT_EQ(write_scene(read_scene(path)), text);
  EXPECT_NE(text.find("flow_rate_m3_s = 500.0"), std::string::npos);
}

// The summit is 195 m high; the duct's rim stands over ground that falls away.
TEST(EmitterScene, VentInTheGroundIsToldWhereTheGroundIs) {
  const std::string text = error_of({"emitter.0.position_m=[-240.0, 190.0, 0.0]"});
  EXPECT_NE(text.find("emitter.0.position_m"), std::string::npos) << text;
  EXPECT_NE(text.find("it is at y = 190 m, and the ground there at 195 m"), std::string::npos) << text;
  EXPECT_NE(text.find("raise it by 5 m"), std::string::npos) << text;
  EXPECT_EQ(error_of({}), "none");
  EXPECT_NE(error_of({"emitter.0.position_m=[-240.0, 100.0, 0.0]"}).find("raise it by 95 m"), std::string::npos);
  EXPECT_NE(
      error_of({"emitter.0.position_m=[-240.0, 205.0, 0.0]", "emitter.0.direction=[0,-1,0]", "particles.spacing_m=4.0"})
          .find("the ground there at"),
      std::string::npos)
      << "the far end of the duct counts";
}

TEST(EmitterScene, AVentWithoutAnEndPoursToTheEndOfTheShot) {
  Scene scene = lava_scene();
  scene.emitters[0].end.reset();
  const SimulationSetup setup = build_simulation(scene);
  const Emitter<3>& emitter = setup.parameters.emitters[0];
  const auto layers = compute_emitter_layers<3>(emitter, setup.parameters.particle_volume, 4.8);
  for (const double time : {0.4, 1.0, 1e6}) {
    const double expected = emitter.flow_rate * time / setup.parameters.particle_volume;
    EXPECT_NEAR(static_cast<double>(count_entered(emitter, layers, time)), expected,
                0.5 * static_cast<double>(layers.sites.size()) + 1.0)
        << time;
  }
  EXPECT_DOUBLE_EQ(count_poured(setup, 1.0), 500.0 / 8.0);
}

// A boulder whose mesh is far from where its first keyframe puts it.
TEST(EmitterScene, CollidersCountWhereTheyStandAtTheStart) {
  Scene scene = lava_scene();
  ColliderSettings boulder;
  boulder.mesh = "assets/sphere.obj";
  boulder.temperature = 300.0;
  boulder.placement.scale = 20.0;
  boulder.placement.translate = Vec3(-240.0, 300.0, 0.0);
  KeyframeSettings first, last;
  first.translate = Vec3(0.0, -100.0, 0.0);
  last.time = 10.0;
  boulder.keyframes = {first, last};
  scene.colliders.push_back(boulder);
  EXPECT_NE(message_of<Error>([&] { build_simulation(scene); }).find("the vent is in collider 1"), std::string::npos);
  scene.colliders[1].keyframes[0].translate = Vec3(500.0, 0.0, 0.0);
  build_simulation(scene);
}

TEST(EmitterScene, ASheetOfTerrainIsGroundHoweverItIsWound) {
  TriangleMesh sheet;
  sheet.vertices = {Vec3(-400, 200, -300), Vec3(400, 200, -300), Vec3(400, 200, 300), Vec3(-400, 200, 300)};
  for (const bool up : {true, false}) {
    sheet.triangles = {{0, 3, 2}, {0, 2, 1}};
    if (!up)
      for (auto& t : sheet.triangles) std::swap(t[0], t[1]);
    const auto path = scene_file().parent_path() / "sheet.obj";
    std::ofstream file(path);
    for (const Vec3& v : sheet.vertices) file << fmt::format("v {} {} {}\n", v[0], v[1], v[2]);
    for (const auto& t : sheet.triangles) file << fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    file.close();
    const std::string mesh = fmt::format("collider.0.mesh={}", path.string());
    EXPECT_NE(error_of({mesh}).find("raise it by 3 m"), std::string::npos) << error_of({mesh});
    EXPECT_EQ(error_of({mesh, "emitter.0.position_m=[-240.0, 200.5, 0.0]"}), "none");
  }
}

TEST(EmitterScene, VentsThatPourIntoEachOtherAreRefused) {
  Scene scene = lava_scene();
  EmitterSettings other = scene.emitters[0];
  other.position += Vec3(14.0, 12.0, 0.0);
  scene.emitters.push_back(other);
  build_simulation(scene);
  scene.emitters[1].position[0] -= 10.0;
  scene.emitters[1].position[1] -= 12.0;
  EXPECT_NE(message_of<Error>([&] { build_simulation(scene); }).find("pours into that of emitter 0"),
            std::string::npos);
  scene.emitters[1].start = 0.6;
  scene.emitters[1].end = 0.9;
  build_simulation(scene);
}

// Nothing but a vent: the domain must hold what it pours.
TEST(EmitterScene, TheDomainHoldsThePile) {
  Scene scene = lava_scene();
  scene.colliders.clear();
  scene.outflows.clear();
  const SimulationSetup setup = build_simulation(scene);
  const double side = std::cbrt(0.6 * 500.0);
  EXPECT_DOUBLE_EQ(pile_size(scene, scene.emitters[0]), side);
  EXPECT_LT(setup.parameters.domain.lower[0], -240.0 - 10.0 * side);
  EXPECT_GT(setup.parameters.domain.upper[1], 197.0 + 10.0 * side);
}

TEST(EmitterScene, RefusesWhatCannotPour) {
  EXPECT_NE(error_of({"emitter.0.flow_rate_m3_s=0"}).find("emitter.0.flow_rate_m3_s: must be a number above 0"),
            std::string::npos);
  EXPECT_NE(
      error_of({"emitter.0.radius_m=1.5"}).find("emitter.0.radius_m: must be at least the spacing of particles, 2 m"),
      std::string::npos);
  EXPECT_NE(error_of({"emitter.0.start_s=0.7"}).find("emitter.0.end_s: must be after start_s = 0.7, is 0.6"),
            std::string::npos);
  EXPECT_NE(error_of({"emitter.0.material=lawa"}).find("did you mean \"lava\"?"), std::string::npos);
  EXPECT_NE(error_of({"emitter.0.direction=[0,0,0]"}).find("emitter.0.direction: must not be zero"), std::string::npos);
  EXPECT_NE(error_of({"solver.density=summation"}).find("emitter.0: goes with [solver] density"), std::string::npos);
  EXPECT_NE(error_of({"outflow.0.upper_m=[-500,0,0]"}).find("outflow.0.upper_m: must be above lower_m"),
            std::string::npos);
  EXPECT_NE(error_of({"collider.0.mesh=assets/bunny.obj", "collider.0.terrain.refine=2"}).find("is no height field"),
            std::string::npos);
  EXPECT_NE(error_of({"collider.0.until_s=0"}).find("collider.0.until_s: must be a number above 0"), std::string::npos);
}

TEST(EmitterScene, TerrainIsRefinedAndPlaced) {
  const Scene scene =
      lava_scene({"collider.0.terrain.refine=2", "collider.0.translate_m=[0,10,0]", "collider.0.terrain.depth_m=20"});
  const TriangleMesh mesh = import_placed_collider(scene, 0);
  const Box3 bounds = compute_bounds(mesh);
  EXPECT_TRUE(compute_topology(mesh).closed());
  EXPECT_NEAR(bounds.extent()[0], 860.0, 1e-9);
  EXPECT_NEAR(bounds.extent()[2], 600.0, 1e-9);
  EXPECT_NEAR(bounds.upper[1], 205.0, 0.5);
  EXPECT_GE(mesh.triangles.size(), 4u * 2u * 86u * 60u);
  EXPECT_FALSE(compute_topology(import_placed_collider(lava_scene({"collider.0.terrain.closed=false"}), 0)).closed());
}

TEST(EmitterScene, ForecastCountsWhatWillBePoured) {
  const SceneForecast f = forecast_scene(lava_scene({"emitter.0.flow_rate_m3_s=8000"}), 3);
  EXPECT_EQ(f.n_particles, 0u);
  EXPECT_EQ(f.n_particles_end, 600u);
  EXPECT_GT(f.bytes, 600.0 * 200.0);
  EXPECT_GT(f.simulate_seconds, 0.0);
  EXPECT_GT(f.surface_seconds, 0.0);
  EXPECT_GT(f.render_seconds, 0.0);
}

// A gate is not drawn any more when it has gone.
TEST(EmitterScene, VanishedColliderIsNotDrawn) {
  const Scene scene = lava_scene({"collider.0.until_s=0.5"});
  RenderScene view = build_view(scene);
  const auto at_start = view.colliders;
  place_colliders(scene, 0.4, {}, at_start, view);
  EXPECT_EQ(view.colliders[0].mesh.triangles.size(), at_start[0].mesh.triangles.size());
  EXPECT_EQ(view.colliders[0].normals.size(), at_start[0].mesh.vertices.size()) << "a terrain is drawn smooth";
  place_colliders(scene, 0.5, {}, at_start, view);
  EXPECT_TRUE(view.colliders[0].mesh.triangles.empty());
}

}  // namespace
}  // namespace smelt
