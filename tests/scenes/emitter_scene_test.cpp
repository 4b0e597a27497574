// Vents, outflow, gates and terrains as scenes state them.
#include "core/error.h"
#include "scenes/build_simulation.h"
#include "scenes/build_view.h"
#include "scenes/check_scene.h"
#include "scenes/scene_reader.h"
#include "scenes/scene_writer.h"
#include "tests/source_folder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

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

Scene lava_scene(const std::vector<std::string>& overrides = {}) { return read_scene(scene_file(), overrides); }

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
  EXPECT_NE(error_of({"emitter.0.position_m=[-240.0, 205.0, 0.0]", "emitter.0.direction=[0,-1,0]", "particles.spacing_m=4.0"}).find("the ground there at"),
            std::string::npos)
      << "the far end of the duct counts";
}

TEST(EmitterScene, RefusesWhatCannotPour) {
  EXPECT_NE(error_of({"emitter.0.flow_rate_m3_s=0"}).find("emitter.0.flow_rate_m3_s: must be a number above 0"), std::string::npos);
  EXPECT_NE(error_of({"emitter.0.radius_m=1.5"}).find("emitter.0.radius_m: must be at least the spacing of particles, 2 m"), std::string::npos);
  EXPECT_NE(error_of({"emitter.0.start_s=0.7"}).find("emitter.0.end_s: must be after start_s = 0.7, is 0.6"), std::string::npos);
  EXPECT_NE(error_of({"emitter.0.material=lawa"}).find("did you mean \"lava\"?"), std::string::npos);
  EXPECT_NE(error_of({"emitter.0.direction=[0,0,0]"}).find("emitter.0.direction: must not be zero"), std::string::npos);
  EXPECT_NE(error_of({"solver.density=summation"}).find("emitter.0: goes with [solver] density"), std::string::npos);
  EXPECT_NE(error_of({"outflow.0.upper_m=[-500,0,0]"}).find("outflow.0.upper_m: must be above lower_m"), std::string::npos);
  EXPECT_NE(error_of({"collider.0.mesh=assets/bunny.obj", "collider.0.terrain.refine=2"}).find("is no height field"), std::string::npos);
  EXPECT_NE(error_of({"collider.0.until_s=0"}).find("collider.0.until_s: must be a number above 0"), std::string::npos);
}

TEST(EmitterScene, TerrainIsRefinedAndPlaced) {
  const Scene scene = lava_scene({"collider.0.terrain.refine=2", "collider.0.translate_m=[0,10,0]", "collider.0.terrain.depth_m=20"});
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
