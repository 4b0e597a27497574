#include "scenes/scene_reader.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "scenes/nearest_word.h"
#include "scenes/scene_writer.h"
#include "tests/source_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <unistd.h>

namespace smelt {
namespace {

const char* const good_scene = R"(
[shot]
name = "test"
frames = 10

[particles]
count = 100

[[material]]
name = "wax"
density_kg_m3 = 900
viscosity = { law = "smd", yield_stress_Pa = 50.0, consistency_Pa_sn = { cold = 20.0, hot = 2.0 }, index = 0.5, jump_number = { cold = 150.0, hot = 15.0 } }
heat = { diffusivity_m2_s = 1e-3, cold_K = 300.0, hot_K = 400.0 }

[[body]]
mesh = "assets/bunny.obj"
material = "wax"
temperature_K = { bottom = 300.0, top = 400.0 }

[[collider]]
mesh = "ground"
)";

std::filesystem::path write_scene_file(const std::string& text) {
  const auto folder = std::filesystem::path(testing::TempDir()) / ("scene_reader_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const auto path = folder / "scene_reader_test.toml";
  std::ofstream(path) << text;
  return path;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string error_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    read_scene(write_scene_file(text), overrides);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

void expect_error(const std::string& text, const std::string& where, const std::string& what) {
  const std::string error = error_of(text);
  EXPECT_NE(error.find(where), std::string::npos) << "looked for \"" << where << "\" in:\n" << error;
  EXPECT_NE(error.find(what), std::string::npos) << "looked for \"" << what << "\" in:\n" << error;
}

TEST(SceneReader, ReadsWhatIsThereAndDefaultsTheRest) {
  const Scene scene = read_scene(write_scene_file(good_scene));
  EXPECT_EQ(scene.shot.name, "test");
  EXPECT_EQ(scene.shot.frames, 10);
  EXPECT_EQ(scene.shot.fps, 24.0);
  EXPECT_EQ(*scene.particles.count, 100);
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].viscosity.yield_stress->cold, 50.0);
  EXPECT_EQ(scene.materials[0].viscosity.yield_stress->hot, 50.0);
  EXPECT_EQ(scene.materials[0].viscosity.consistency->hot, 2.0);
  EXPECT_EQ(scene.materials[0].heat->hot, 400.0);
  EXPECT_EQ(scene.bodies[0].temperature->top, 400.0);
  EXPECT_EQ(scene.camera.width, 1280);
}

TEST(SceneReader, UnknownKeyNamesTheNearest) {
  expect_error(replaced(good_scene, "frames = 10", "frames = 10\nfpss = 25"),
               "scene_reader_test.toml:5: shot.fpss: unknown key", "did you mean `fps`?");
  expect_error(replaced(good_scene, "density_kg_m3 = 900", "density_kg_m3 = 900\ndensity = 900"),
               ":12: material.0.density: unknown key", "did you mean `density_kg_m3`?");
  expect_error(std::string(good_scene) + "[graviti]\n", "graviti: unknown key", "did you mean `gravity`?");
}

TEST(SceneReader, APowerLawFluidNeedsARelaxedStress) {
  const std::string melts =
      replaced(good_scene, "yield_stress_Pa = 50.0", "yield_stress_Pa = { cold = 50.0, hot = 0.0 }");
  read_scene(write_scene_file(melts));
  expect_error(melts + "[solver]\nshear_wave_speed_m_s = 0\n", "solver.shear_wave_speed_m_s",
               "is a power-law fluid where its yield_stress_Pa is 0");
  read_scene(write_scene_file(replaced(melts, "index = 0.5", "index = 1.0") + "[solver]\nshear_wave_speed_m_s = 0\n"));
}

TEST(SceneReader, WrongTypeMissingKeyAndRange) {
  expect_error(replaced(good_scene, "frames = 10", "frames = \"ten\""), ":4: shot.frames",
               "must be a whole number from 1 and up to 100000, is a text");
  expect_error(replaced(good_scene, "frames = 10", ""), ":2: shot.frames", "missing: number of frames");
  expect_error(replaced(good_scene, "frames = 10", "frames = 0"), ":4: shot.frames", "is 0");
  expect_error(replaced(good_scene, "index = 0.5", "index = 1.5"), "material.0.viscosity.index",
               "above 0 and up to 1, is 1.5");
  expect_error(replaced(good_scene, "density_kg_m3 = 900", "density_kg_m3 = nan"), ":11: material.0.density_kg_m3",
               "is nan");
  expect_error(replaced(good_scene, "law = \"smd\"", "law = \"smud\""), "viscosity.law",
               "\"smud\" is none of smd, newtonian, inviscid");
  expect_error(replaced(good_scene, "{ bottom = 300.0, top = 400.0 }", "{ bottom = 300.0 }"), "temperature_K.top",
               "missing");
}

TEST(SceneReader, ContradictionsAndNames) {
  expect_error(replaced(good_scene, "count = 100", "count = 100\nspacing_m = 0.1"), ":8: particles.spacing_m",
               "not both");
  expect_error(replaced(good_scene, "count = 100", ""), ":6: particles.count", "give count or spacing_m");
  expect_error(replaced(good_scene, "material = \"wax\"", "material = \"wacks\""), ":17: body.0.material",
               "there is no [[material]] named \"wacks\"");
  expect_error(replaced(good_scene, "assets/bunny.obj", "assets/bunni.obj"), ":16: body.0.mesh", "there is no file");
  expect_error(replaced(good_scene, "index = 0.5", "index = 0.5, rest_viscosity_Pa_s = 5.0"), "rest_viscosity_Pa_s",
               "not both");
  expect_error(replaced(good_scene, "hot_K = 400.0", "hot_K = 300.0"), "heat.hot_K", "must be above cold_K = 300");
  expect_error(replaced(good_scene, "heat = {", "# heat = {"), "temperature_K", "has no heat");
}

// What the surfaces of a scene would be refused for is said before it is simulated.
TEST(SceneReader, SurfacesAreLookedAtBeforeTheSimulation) {
  const std::string surface = std::string(good_scene) + "[surface]\n";
  expect_error(surface + "cell_over_spacing = 1.0\nkernel_over_spacing = 0.65\n", ":23: surface.cell_over_spacing",
               "at most 1.5 times kernel_over_spacing = 0.65");
  EXPECT_EQ(error_of(surface + "cell_over_spacing = 1.0\nkernel_over_spacing = 0.67\n"), "no error");
  expect_error(surface + "vertex_colours = true\ncolour_hot_K = 300\ncolour_cold_K = 400\n",
               ":24: surface.colour_hot_K", "must be above colour_cold_K = 400");
  EXPECT_EQ(error_of(surface + "colour_hot_K = 300\ncolour_cold_K = 400\n"), "no error") << "nobody asks for colours";
  std::string cold = replaced(surface, "heat = {", "# heat = {");
  cold = replaced(cold, "temperature_K = {", "# temperature_K = {");
  expect_error(cold + "vertex_colours = true\n", ":23: surface.vertex_colours", "no material has heat");
}

TEST(SceneReader, KeyframesAreRisingAndMoreThanOne) {
  const std::string collider = replaced(good_scene, "mesh = \"ground\"", "mesh = \"assets/sphere.obj\"\n");
  const auto keys = [&](const std::string& list) { return collider + "keyframes = [" + list + "]\n"; };
  EXPECT_EQ(error_of(keys("{ time_s = 0.0 }, { time_s = 1.0, translate_m = [0, 1, 0], rotate_deg = [0, 0, 170] }")),
            "no error");
  expect_error(keys("{ time_s = 1.0 }, { time_s = 0.5 }"), ":23: collider.0.keyframes.1.time_s",
               "must be later than the keyframe before, at 1 s, is 0.5; put the keyframes in order");
  expect_error(keys("{ time_s = 1.0 }"), ":23: collider.0.keyframes", "one keyframe moves nothing: give two or more");
  expect_error(keys("{ time_s = 0.0 }, { translate_m = [0, 1, 0] }"), "collider.0.keyframes.1.time_s", "missing");
  expect_error(keys("{ time_s = 0.0 }, { time_s = 1.0, rotate_deg = [0, 360, 0] }"), "keyframes.1.rotate_deg",
               "may go either way");
  expect_error(keys("{ time_s = 0.0 }, { time_s = 1.0 }") + "velocity_m_s = [1, 0, 0]\n", "collider.0.velocity_m_s",
               "not both");
  expect_error(keys("{ time_s = 0.0 }, { time_s = 1.0 }") + "angular_velocity_rad_s = [1, 0, 0]\n",
               "collider.0.angular_velocity_rad_s", "not both");
  expect_error(std::string(good_scene) + "keyframes = [{ time_s = 0.0 }, { time_s = 1.0 }]\n", "collider.0.keyframes",
               "cannot move");
  expect_error(std::string(good_scene) + "angular_velocity_rad_s = [0, 1, 0]\n", "collider.0.angular_velocity_rad_s",
               "cannot move");
}

TEST(SceneReader, RigidBodies) {
  const std::string collider = replaced(good_scene, "mesh = \"ground\"", "mesh = \"assets/sphere.obj\"\n");
  EXPECT_EQ(error_of(collider + "density_kg_m3 = 7800.0\nvelocity_m_s = [1, 0, 0]\n"), "no error");
  expect_error(collider + "mass_kg = 0.0\n", ":23: collider.0.mass_kg", "above 0, is 0");
  expect_error(collider + "mass_kg = 1.0\ndensity_kg_m3 = 7800.0\n", ":24: collider.0.density_kg_m3", "not both");
  expect_error(collider + "mass_kg = 1.0\nkeyframes = [{ time_s = 0.0 }, { time_s = 1.0 }]\n", "collider.0.keyframes",
               "a rigid body goes where it is pushed");
  expect_error(collider + "mass_kg = 1.0\npivot_m = [0, 0, 0]\n", "collider.0.pivot_m", "centre of mass");
  expect_error(std::string(good_scene) + "mass_kg = 1.0\n", "collider.0.mass_kg", "cannot move");
}

TEST(SceneReader, PeriodicBox) {
  const std::string box = std::string(good_scene) + "[periodic]\n";
  expect_error(box, "periodic.lower_m: missing", "periodic.upper_m: missing");
  expect_error(box + "lower_m = [0, 0, 0]\nupper_m = [1, 1, 0]\naxes = \"xz\"\n", ":24: periodic.upper_m",
               "must be above lower_m along z, is 0 and 0");
  expect_error(box + "axes = \"zx\"\n", ":23: periodic.axes", "\"zx\" is none of x, y, z, xy, xz, yz, xyz");
  const Scene scene = read_scene(write_scene_file(box + "lower_m = [0, 0, 0]\nupper_m = [1, 1, 0]\naxes = \"xy\"\n"));
  EXPECT_EQ(scene.periodic->axes, "xy");
  EXPECT_FALSE(read_scene(write_scene_file(good_scene)).periodic.has_value());
  const std::string text = write_scene(scene);
  EXPECT_EQ(write_scene(read_scene(write_scene_file(text))), text);
}

TEST(SceneReader, SolverChoices) {
  const std::string solver = std::string(good_scene) + "[solver]\n";
  expect_error(solver + "kernel = \"gaussian\"\n", ":23: solver.kernel",
               "is none of cubic_spline, quintic_spline, quadratic");
  expect_error(solver + "equation_of_state = \"ideal_gas\"\n", "solver.equation_of_state", "is none of linear, tait");
  expect_error(solver + "density = \"sum\"\n", "solver.density",
               "is none of continuity, summation, normalised_summation");
  expect_error(solver + "background_pressure_Pa = -1\n", "solver.background_pressure_Pa", "of at least 0, is -1");
}

TEST(SceneReader, ColliderChoices) {
  const std::string ground = std::string(good_scene) + "[[collider]]\nmesh = \"ground\"\n";
  expect_error(ground + "velocity_m_s = [0, 1, 0]\n", "collider.1.velocity_m_s",
               "the ground has no end and cannot move");
  expect_error(ground + "wall = 1\n", "collider.1.wall", "must be true or false");
  expect_error(ground + "temperature_K = 500\nwall = false\n", "collider.1.temperature_K",
               "heat passes through walls only");
}

/// The good scene with more in its heat.
std::string with_heat(const std::string& more) {
  return replaced(good_scene, "hot_K = 400.0 }", "hot_K = 400.0, " + more + " }");
}
const std::string with_air = "[ambient]\ntemperature_K = 290\nheat_transfer_W_m2K = 10\n";

TEST(SceneReader, LatentHeatAndWhatTheSurfaceLoses) {
  const Scene scene = read_scene(write_scene_file(
      with_heat("specific_heat_J_kgK = 2000, latent_heat_J_kg = 2e5, emissivity = 0.9") + with_air +
      "[[heat_source]]\nposition_m = [1, 2, 3]\nradius_m = 0.1\ntemperature_K = 1600\nheat_transfer_W_m2K = 50\n"
      "from_s = 1\nuntil_s = 2\n"));
  EXPECT_EQ(scene.materials[0].heat->specific_heat, 2000.0);
  EXPECT_EQ(scene.materials[0].heat->latent_heat, 2e5);
  EXPECT_EQ(*scene.ambient->temperature, 290.0);
  EXPECT_EQ(*scene.heat_sources.at(0).temperature, 1600.0);
  const std::string text = write_scene(scene);
  EXPECT_EQ(write_scene(read_scene(write_scene_file(text))), text);
  // A sharp melting point is one temperature.
  EXPECT_NO_THROW(read_scene(write_scene_file(
      replaced(with_heat("specific_heat_J_kgK = 2000, latent_heat_J_kg = 2e5"), "hot_K = 400.0", "hot_K = 300.0"))));
}

TEST(SceneReader, HeatThatCannotBe) {
  expect_error(with_heat("latent_heat_J_kg = 2e5"), "heat.latent_heat_J_kg", "needs specific_heat_J_kgK");
  expect_error(with_heat("specific_heat_J_kgK = 2000, emissivity = 1.5") + with_air, "heat.emissivity",
               "from 0 and up to 1, is 1.5");
  expect_error(with_heat("specific_heat_J_kgK = 2000, emissivity = 0.9"), "heat.emissivity", "needs an [ambient]");
  expect_error(with_heat("specific_heat_J_kgK = 2000") + "[ambient]\nheat_transfer_W_m2K = 10\n",
               ":22: ambient.temperature_K", "missing");
  expect_error(with_heat("specific_heat_J_kgK = 2000") + "[ambient]\ntemperature_K = 290\n",
               "ambient.heat_transfer_W_m2K", "nothing is lost");
  expect_error(with_heat("specific_heat_J_kgK = 2000") + "[ambient]\ntemperature_K = -5\nheat_transfer_W_m2K = 1\n",
               ":23: ambient.temperature_K", "of at least 0, is -5");
  expect_error(std::string(good_scene) + with_air, "heat.specific_heat_J_kgK",
               "missing: [ambient] and [[heat_source]] exchange energy");
  expect_error(replaced(good_scene, "cold_K = 300.0", "cold_K = -300.0"), "heat.cold_K", "of at least 0, is -300");
}

TEST(SceneReader, HeatSourcesThatCannotBe) {
  const std::string source = with_heat("specific_heat_J_kgK = 2000") + "[[heat_source]]\n";
  expect_error(source, "heat_source.0.radius_m", "missing");
  expect_error(source + "radius_m = 1\n", "heat_source.0.power_W", "give power_W, or temperature_K");
  expect_error(source + "radius_m = 1\npower_W = 5\ntemperature_K = 900\n", "heat_source.0.power_W", "not both");
  expect_error(source + "radius_m = 1\ntemperature_K = 900\n", "heat_source.0.heat_transfer_W_m2K", "missing");
  expect_error(source + "radius_m = 1\npower_W = 5\nfrom_s = 3\nuntil_s = 2\n", "heat_source.0.until_s",
               "must be after from_s = 3, is 2");
  expect_error(source + "radius_m = 0\npower_W = 5\n", "heat_source.0.radius_m", "above 0, is 0");
}

TEST(SceneReader, PropertiesThatFollowTemperature) {
  const auto with_yield = [](const std::string& value) {
    return replaced(good_scene, "yield_stress_Pa = 50.0", "yield_stress_Pa = " + value);
  };
  const Scene table =
      read_scene(write_scene_file(with_yield("{ temperature_K = [300, 350, 400], values = [50, 5, 0] }")));
  EXPECT_EQ(table.materials[0].viscosity.yield_stress->value, (std::vector<double>{50.0, 5.0, 0.0}));
  const Scene exponential =
      read_scene(write_scene_file(with_yield("{ reference = 50, reference_K = 300, rate_1_K = 0.05 }")));
  EXPECT_EQ(exponential.materials[0].viscosity.yield_stress->rate, 0.05);
  for (const Scene& scene : {table, exponential}) {
    const std::string text = write_scene(scene);
    EXPECT_EQ(write_scene(read_scene(write_scene_file(text))), text);
  }
  expect_error(with_yield("{ temperature_K = [300, 350, 350], values = [50, 5, 0] }"), "yield_stress_Pa.temperature_K",
               "must rise from one to the next, but 350 is followed by 350");
  expect_error(with_yield("{ temperature_K = [300, 350], values = [50] }"), "yield_stress_Pa.values",
               "must be as many as temperature_K, which has 2, are 1");
  expect_error(with_yield("{ temperature_K = [300], values = [50] }"), "yield_stress_Pa.temperature_K", "at least two");
  expect_error(with_yield("{ temperature_K = [300, 350], values = [50, -1] }"), "yield_stress_Pa.values[1]",
               "of at least 0, is -1");
  expect_error(with_yield("{ reference = 50, rate_1_K = 0.05 }"), "yield_stress_Pa.reference_K", "missing");
  expect_error(replaced(with_yield("{ reference = 50, reference_K = 300, rate_1_K = 0.05 }"), "heat = {", "# heat = {"),
               "yield_stress_Pa", "follows temperature, but the material has no heat");
}

TEST(SceneReader, ReportsAllErrorsAtOnceInTheOrderOfTheFile) {
  std::string bad = replaced(good_scene, "frames = 10", "frames = -1\ncolour = 3");
  bad = replaced(bad, "material = \"wax\"", "material = \"lava\"");
  bad = replaced(bad, "count = 100", "count = 1.5");
  const std::string error = error_of(bad);
  EXPECT_EQ(error.find("4 errors in"), 0u) << error;
  const std::size_t a = error.find("shot.frames"), b = error.find("shot.colour"), c = error.find("particles.count"),
                    d = error.find("body.0.material");
  EXPECT_LT(a, b);
  EXPECT_LT(b, c);
  EXPECT_LT(c, d);
  EXPECT_NE(d, std::string::npos);
}

TEST(SceneReader, SyntaxErrorsHaveLineAndColumn) {
  const std::string error = error_of("[shot]\nname = \"x\nframes = 1\n");
  EXPECT_NE(error.find("scene_reader_test.toml:2:"), std::string::npos) << error;
  EXPECT_NE(error.find("not valid TOML"), std::string::npos) << error;
}

TEST(SceneReader, OverridesFromTheCommandLine) {
  const Scene scene = read_scene(write_scene_file(good_scene),
                                 {"shot.frames=3", "body.0.scale=0.5", "surface.iso_value=0.4", "shot.name=other"});
  EXPECT_EQ(scene.shot.frames, 3);
  EXPECT_EQ(*scene.bodies[0].placement.scale, 0.5);
  EXPECT_EQ(scene.surface.iso_value, 0.4);
  EXPECT_EQ(scene.shot.name, "other");
  EXPECT_NE(error_of(good_scene, {"shot.framse=3"})
                .find("--set shot.framse=3: shot.framse: unknown key; did you mean `frames`?"),
            std::string::npos);
  EXPECT_NE(error_of(good_scene, {"shot.frames=0"}).find("--set shot.frames=0: shot.frames: must be"),
            std::string::npos);
  EXPECT_NE(error_of(good_scene, {"body.3.scale=1"}).find("must be a number below 1"), std::string::npos);
  EXPECT_NE(error_of(good_scene, {"nonsense"}).find("must be key.path=value"), std::string::npos);
}

TEST(SceneWriter, WhatIsWrittenReadsBackTheSame) {
  const Scene scene = read_scene(write_scene_file(good_scene));
  const std::string text = write_scene(scene);
  EXPECT_EQ(write_scene(read_scene(write_scene_file(text))), text);
  EXPECT_NE(text.find("fps = 24.0"), std::string::npos) << "defaults are written out:\n" << text;
}

TEST(SceneWriter, SectionsTellWhatChanged) {
  const Scene scene = read_scene(write_scene_file(good_scene));
  Scene other = scene;
  other.look.exposure = 2.0;
  other.shot.frames = 20;
  EXPECT_EQ(write_section(scene, SceneSection::simulation), write_section(other, SceneSection::simulation));
  EXPECT_NE(write_section(scene, SceneSection::render), write_section(other, SceneSection::render));
  other.materials[0].density = 901.0;
  EXPECT_NE(write_section(scene, SceneSection::simulation), write_section(other, SceneSection::simulation));
}

TEST(SceneWriter, ReferencePageIsWhatTheCodeSays) {
  EXPECT_EQ(read_file(source_folder() / "docs/scene.md"), write_scene_reference())
      << "print it anew: ./smelt scene-reference > docs/scene.md";
}

TEST(SceneReader, EverySceneOfTheProjectIsSound) {
  int n = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(source_folder() / "scenes")) {
    if (entry.path().extension() != ".toml") continue;
    EXPECT_NO_THROW(read_scene(entry.path())) << entry.path();
    ++n;
  }
  EXPECT_GE(n, 1);
}

TEST(NearestWord, FindsTyposAndMissingUnits) {
  const std::vector<std::string> known = {"density_kg_m3", "frames", "fps"};
  EXPECT_EQ(nearest_word("framse", known), "frames");
  EXPECT_EQ(nearest_word("density", known), "density_kg_m3");
  EXPECT_EQ(nearest_word("zebra", known), std::nullopt);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
}

TEST(Quality, SetsDefaultsThatTheSceneMayOverrule) {
  const auto path = write_scene_file(good_scene);
  const Scene plain = read_scene(path);
  const Scene preview = read_scene(path, {"shot.quality=preview"});
  EXPECT_EQ(*preview.particles.count, *plain.particles.count / 4);
  EXPECT_GT(preview.surface.cell_over_spacing, plain.surface.cell_over_spacing);
  EXPECT_EQ(preview.camera.width, plain.camera.width / 2);
  EXPECT_GT(read_scene(path, {"shot.quality=final"}).render.samples, plain.render.samples);
  const Scene study = read_scene(path, {"shot.quality=study", "time_step.courant=0.1"});
  EXPECT_EQ(study.solver.precision, "double");
  EXPECT_EQ(study.solver.xsph, 0.0);
  EXPECT_EQ(study.time_step.courant, 0.1);
}

TEST(Quality, IsAppliedOnce) {
  const Scene preview = read_scene(write_scene_file(good_scene), {"shot.quality=preview"});
  const Scene again = read_scene(write_scene_file(write_scene(preview)));
  EXPECT_EQ(*again.particles.count, *preview.particles.count);
  EXPECT_EQ(again.surface.cell_over_spacing, preview.surface.cell_over_spacing);
}

TEST(Quality, UnknownOnesAreRefused) {
  EXPECT_NE(error_of(good_scene, {"shot.quality=best"}).find("shot.quality"), std::string::npos);
}

}  // namespace
}  // namespace smelt
