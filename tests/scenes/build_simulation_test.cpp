#include "scenes/build_simulation.h"

#include "core/error.h"
#include "scenes/build_view.h"
#include "scenes/scene_reader.h"
#include "tests/source_folder.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace smelt {
namespace {

Scene bunny_scene(const std::vector<std::string>& overrides = {}) {
  return read_scene(source_folder() / "scenes/melting_bunny.toml", overrides);
}

TEST(BuildSimulation, BunnyHasTheCountAndTheMass) {
  const SimulationSetup setup = build_simulation(bunny_scene());
  EXPECT_NEAR(static_cast<double>(setup.particles.size()), 10188.0, 0.01 * 10188.0);
  const double mass =
      static_cast<double>(setup.particles.size()) * setup.parameters.particle_volume * setup.materials[0].density;
  EXPECT_NEAR(mass / (900.0 * 0.194288), 1.0, 1e-3);
  EXPECT_TRUE(setup.warnings.empty());
}

TEST(BuildSimulation, TemperatureRunsFromBottomToTop) {
  const SimulationSetup setup = build_simulation(bunny_scene({"particles.count=500"}));
  for (std::size_t i = 0; i < setup.particles.size(); ++i) {
    const double expected = 300.0 + 100.0 * setup.particles.position[i][1] / setup.body_bounds.extent()[1];
    ASSERT_NEAR(setup.particles.temperature[i], expected, 1e-9);
  }
}

TEST(BuildSimulation, PlacementScalesTurnsAndStands) {
  const SimulationSetup setup = build_simulation(bunny_scene(
      {"particles.count=500", "body.0.scale=0.2", "body.0.rotate_deg=[0,0,90]", "body.0.stand_at_y_m=1.5"}));
  EXPECT_NEAR(setup.body_bounds.lower[1], 1.5, 1e-12);
  // Turned by 90 degrees about z, its length along x is now its height.
  EXPECT_NEAR(setup.body_bounds.extent()[1], 0.2 * (4.94885 + 4.958475), 1e-5);
}

TEST(BuildSimulation, BodiesShareTheCountByVolume) {
  Scene scene = bunny_scene({"particles.count=3000"});
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[1].placement.scale = 0.2;
  scene.bodies[1].placement.translate = Vec3(3, 0, 0);
  const SimulationSetup setup = build_simulation(scene);
  const auto n_small = std::count_if(setup.particles.position.begin(), setup.particles.position.end(),
                                     [](const Vec3& x) { return x[0] < 1.5; });
  EXPECT_NEAR(static_cast<double>(n_small), 3000.0 / 9.0, 0.02 * 3000.0 / 9.0);
  EXPECT_NEAR(static_cast<double>(setup.particles.size()), 3000.0, 30.0);
}

TEST(BuildSimulation, CollidersCarryWhatTheSceneSaysOfThem) {
  Scene scene =
      bunny_scene({"particles.count=500", "collider.0.friction=0.4", "collider.0.surface_velocity_m_s=[1,0,0]"});
  scene.colliders.push_back(scene.colliders[0]);
  ColliderSettings& press = scene.colliders[1];
  press.mesh = "assets/bunny.obj";
  press.placement.scale = 0.1;
  press.placement.translate = Vec3(0, 2, 0);
  press.velocity = Vec3(0, -0.5, 0);
  press.temperature = 450.0;
  Colliders<3> colliders = build_colliders(build_simulation(scene));
  ASSERT_EQ(colliders.placed().size(), 2u);
  const Obstacle<3>& ground = colliders.placed()[0].obstacle;
  EXPECT_EQ(ground.response.friction, 0.4);
  EXPECT_EQ(ground.surface_velocity, Vec3(1, 0, 0));
  EXPECT_FALSE(ground.closed);
  EXPECT_TRUE(ground.wall);
  EXPECT_FALSE(ground.temperature.has_value());
  EXPECT_TRUE(colliders.placed()[1].obstacle.closed);
  EXPECT_EQ(colliders.placed()[1].obstacle.temperature, 450.0);
  colliders.place_at(2.0);
  EXPECT_EQ(colliders.placed()[1].begin.translation, Vec3(0, -1, 0));

  // Pictures show it where the simulation has it.
  RenderScene view = build_view(scene);
  const auto at_start = view.colliders;
  ASSERT_EQ(at_start.size(), 1u);
  place_colliders(scene, 2.0, {}, at_start, view);
  EXPECT_EQ(view.colliders[0].mesh.vertices[7], Vec3(at_start[0].mesh.vertices[7] - Vec3(0, 1, 0)));
  place_colliders(scene, 0.0, {}, at_start, view);
  EXPECT_EQ(view.colliders[0].mesh.vertices[7], at_start[0].mesh.vertices[7]);
}

TEST(BuildSimulation, AClosedColliderAroundFluidIsAContainer) {
  Scene scene = bunny_scene({"particles.count=500"});
  ColliderSettings vessel = scene.colliders[0];
  vessel.mesh = "assets/bad/inverted_box.obj";
  vessel.placement.scale = 4.0;
  vessel.placement.translate = Vec3(-2, -1, -2);
  scene.colliders = {vessel};
  EXPECT_FALSE(build_colliders(build_simulation(scene)).placed()[0].obstacle.closed);
  scene.colliders[0].placement.translate = Vec3(5, 0, 0);
  EXPECT_TRUE(build_colliders(build_simulation(scene)).placed()[0].obstacle.closed);
}

TEST(BuildSimulation, RefusesABodyUnderTheGround) {
  Scene scene = bunny_scene({"body.0.stand_at_y_m=-0.2"});
  try {
    build_simulation(scene);
    FAIL() << "it was accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("0.2 m below the ground"), std::string::npos) << error.what();
  }
}

TEST(BuildSimulation, BrokenMeshesAreMendedWithAWarningOrRefused) {
  Scene scene = bunny_scene({"particles.count=800"});
  scene.bodies[0].placement.scale = 1.0;
  scene.bodies[0].mesh = "assets/bad/open_box.obj";
  const SimulationSetup setup = build_simulation(scene);
  ASSERT_EQ(setup.warnings.size(), 1u);
  EXPECT_NE(setup.warnings[0].find("open_box.obj"), std::string::npos);
  for (const char* bad : {"assets/bad/empty.obj", "assets/bad/flat.obj", "assets/bad/nan.obj"}) {
    scene.bodies[0].mesh = bad;
    try {
      build_simulation(scene);
      ADD_FAILURE() << bad << " was accepted";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(bad), std::string::npos) << error.what();
    }
  }
}

TEST(BuildSimulation, SolverChoicesReachTheSolver) {
  const SimulationSetup plain = build_simulation(bunny_scene({"particles.count=500"}));
  EXPECT_EQ(plain.parameters.kernel, KernelType::cubic_spline);
  EXPECT_EQ(plain.parameters.density, DensityForm::continuity);
  EXPECT_TRUE(plain.parameters.period.empty());
  const SimulationSetup chosen = build_simulation(
      bunny_scene({"particles.count=500", "solver.kernel=quintic_spline", "solver.equation_of_state=tait",
                   "solver.background_pressure_Pa=7.5", "solver.density=normalised_summation",
                   "periodic={axes=\"xz\", lower_m=[-2, 9, -3], upper_m=[2, 9, 3]}"}));
  EXPECT_EQ(chosen.parameters.kernel, KernelType::quintic_spline);
  EXPECT_EQ(chosen.parameters.equation_of_state.law, PressureLaw::tait);
  EXPECT_EQ(chosen.parameters.equation_of_state.background_pressure, 7.5);
  EXPECT_EQ(chosen.parameters.density, DensityForm::normalised_summation);
  EXPECT_TRUE(is_periodic(chosen.parameters.period, 0));
  EXPECT_FALSE(is_periodic(chosen.parameters.period, 1));
  EXPECT_EQ(chosen.parameters.period.upper[2], 3.0);
}

TEST(BuildSimulation, RefusesABodyAcrossAPeriodicFace) {
  try {
    build_simulation(
        bunny_scene({"particles.count=500", "periodic={axes=\"x\", lower_m=[0, 0, 0], upper_m=[2, 0, 0]}"}));
    FAIL() << "it was accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("m out of the [periodic] box along x"), std::string::npos) << error.what();
  }
}

TEST(BuildSimulation, NewtonianScenesNeedNoRelaxedStress) {
  const SimulationSetup setup = build_simulation(bunny_scene(
      {"particles.count=500", "material.0.viscosity={law=\"newtonian\", viscosity_Pa_s={cold=10.0,hot=1.0}}"}));
  EXPECT_EQ(setup.parameters.shear_wave_speed, 0.0);
  EXPECT_EQ(setup.materials[0].rheology.yield_stress.cold, 0.0);
  EXPECT_EQ(setup.materials[0].rheology.consistency.hot, 1.0);
}

TEST(BuildSimulation, RigidBodiesAreWeighedAndSound) {
  Scene scene = bunny_scene({"particles.count=500"});
  scene.colliders.push_back(scene.colliders[0]);
  ColliderSettings& ball = scene.colliders[1];
  ball.mesh = "assets/sphere.obj";
  ball.placement.scale = 0.1;
  ball.placement.translate = Vec3(0, 3, 0);
  ball.density = 7800.0;
  const SimulationSetup setup = build_simulation(scene);
  EXPECT_NEAR(*setup.obstacles[1].mass, 7800.0 * 4.18879e-3, 0.02 * 7800.0 * 4.18879e-3);
  const Colliders<3> colliders = build_colliders(setup);
  ASSERT_EQ(colliders.body_states().size(), 1u);
  EXPECT_NEAR((colliders.body_states()[0].centre - Vec3(0, 3, 0)).norm(), 0.0, 1e-9);

  const auto error_with = [&](const std::string& mesh) -> std::string {
    ball.mesh = mesh;
    try {
      build_simulation(scene);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(error_with("assets/bad/open_box.obj").find("a rigid body needs a closed mesh, and this one has holes"),
            std::string::npos);
  EXPECT_NE(error_with("assets/bad/flat.obj"), "");
  ball.mesh = "assets/bad/inverted_box.obj";
  const SimulationSetup turned = build_simulation(scene);
  EXPECT_GT(*turned.obstacles[1].mass, 0.0);
  EXPECT_EQ(turned.warnings.size(), 1u);
}

}  // namespace
}  // namespace smelt
