// The program as a user meets it: the real binary, its files, its exit codes.

#include "tests/cli/command_line.h"

#include "io/atomic_file.h"
#include "io/exr.h"
#include "io/obj.h"
#include "io/particles_vdb.h"
#include "io/png.h"
#include "tests/source_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <vector>

namespace smelt {
namespace {

TEST_F(CommandLine, RunMakesEveryFileAndATrueReport) {
  const Result result = run({"run", small_scene(), "-o", output("out")});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("frames    1-4"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("simulate"), std::string::npos);
  const fs::path out = output("out");
  const auto report = nlohmann::json::parse(read_file(out / "run.json"));
  ASSERT_EQ(report["frames"].size(), 4u);
  const double mass = report["frames"][0]["simulate"]["mass_kg"];
  for (int frame = 1; frame <= 4; ++frame) {
    const ParticleFrame particles = read_particles(out / fmt::format("particles/particles.{:04}.vdb", frame));
    EXPECT_EQ(particles.frame, frame);
    EXPECT_NEAR(static_cast<double>(particles.size()), 700.0, 7.0);
    EXPECT_TRUE(fs::exists(out / fmt::format("surface/surface.{:04}.vdb", frame)));
    EXPECT_FALSE(read_obj(out / fmt::format("surface/surface.{:04}.obj", frame)).mesh.triangles.empty());
    EXPECT_EQ(read_png(out / fmt::format("frames/frame.{:04}.png", frame)).width, 160);
    const auto& entry = report["frames"][frame - 1];
    EXPECT_EQ(entry["frame"], frame);
    EXPECT_NEAR(entry["simulate"]["mass_kg"].get<double>() / mass, 1.0, 1e-12);
    EXPECT_GT(entry["surface"]["volume_m3"].get<double>(), 0.0);
    for (const char* stage : {"simulate", "surface", "render"}) {
      EXPECT_GT(entry[stage]["seconds"].get<double>(), 0.0);
      EXPECT_GT(entry[stage]["bytes"].get<double>(), 0.0);
    }
    if (frame == 1) continue;
    const auto& dt = entry["simulate"]["dt_s"];
    EXPECT_GT(entry["simulate"]["steps"].get<int>(), 10);
    EXPECT_LE(dt["min"].get<double>(), dt["mean"].get<double>());
    EXPECT_LE(dt["mean"].get<double>(), dt["max"].get<double>());
    EXPECT_NEAR(dt["mean"].get<double>() * entry["simulate"]["steps"].get<int>(), 1.0 / 24.0, 1e-9);
    const auto& heat = entry["simulate"]["heat"];
    const auto passed = [&](const char* way) { return heat["since_last_frame_J"][way].get<double>(); };
    EXPECT_NEAR(passed("from_sources"), 20000.0 / 24.0, 1e-6);
    const double lost = passed("radiated") + passed("convected") + passed("to_walls");
    EXPECT_GT(lost, 0.0);
    const double earlier = report["frames"][frame - 2]["simulate"]["heat"]["enthalpy_J"];
    EXPECT_NEAR(heat["enthalpy_J"].get<double>() - earlier, passed("from_sources") - lost, 1e-5 * lost);
  }
  // Stages alone, from what the folder holds.
  const std::string first = read_file(out / "frames/frame.0003.png");
  EXPECT_EQ(run({"surface", small_scene(), "-o", output("out"), "--frames", "3"}).status, 0);
  EXPECT_EQ(run({"render", small_scene(), "-o", output("out"), "--frames", "3"}).status, 0);
  EXPECT_EQ(read_file(out / "frames/frame.0003.png"), first);
  // The scene as run is a scene.
  EXPECT_EQ(run({"check", (out / "scene.toml").string()}).status, 0);
  // The same command again: the earlier result is kept under another name.
  EXPECT_EQ(run({"run", small_scene(), "-o", output("out"), "--frames", "1"}).status, 0);
  EXPECT_TRUE(fs::exists(output("out.1") + "/frames/frame.0004.png"));
}

TEST_F(CommandLine, SameBytesOnOneAndTwoThreads) {
  ASSERT_EQ(run({"run", small_scene(), "-o", output("one"), "--threads", "1"}).status, 0);
  ASSERT_EQ(run({"run", small_scene(), "-o", output("two"), "--threads", "2"}).status, 0);
  expect_same_files(output("one") + "/particles", output("two") + "/particles", 4);
  expect_same_files(output("one") + "/surface", output("two") + "/surface", 8);
  expect_same_files(output("one") + "/frames", output("two") + "/frames", 4);
}

TEST_F(CommandLine, KilledAtAnyMomentItResumesToTheSameBytes) {
  ASSERT_EQ(run({"simulate", small_scene(), "-o", output("whole")}).status, 0);
  // Killed again and again, each time a little later.
  bool done = false;
  for (int k = 0; k < 60 && !done; ++k) {
    const pid_t child = start({"simulate", small_scene(), "-o", output("cut"), "--resume"});
    for (int wait = 0; wait < 40 + 45 * k; wait += 5) {
      int status = 0;
      if (waitpid(child, &status, WNOHANG) == child) {
        ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << read_file(folder_ / "stderr.txt");
        done = true;
        break;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    if (done) break;
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
  }
  if (!done) {
    ASSERT_EQ(run({"simulate", small_scene(), "-o", output("cut"), "--resume"}).status, 0);
  }
  expect_same_files(output("whole") + "/particles", output("cut") + "/particles", 4);
}

TEST_F(CommandLine, InterruptedItSaysSoAndKeepsWhatIsDone) {
  const pid_t child = start({"simulate", small_scene(), "-o", output("out"), "--set", "shot.frames=400"});
  for (int wait = 0; wait < 6000 && !fs::exists(output("out") + "/particles/particles.0002.vdb"); ++wait)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  kill(child, SIGINT);
  const Result result = finish(child);
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_NE(result.err.find("--resume goes on"), std::string::npos) << result.err;
  EXPECT_NO_THROW(read_particles(output("out") + "/particles/particles.0002.vdb"));
}

TEST_F(CommandLine, ABadSceneIsExitThreeAndNothingIsWritten) {
  const Result result =
      run({"run", small_scene(), "-o", output("out"), "--set", "shot.framse=3", "--set", "particles.count=-1"});
  EXPECT_EQ(result.status, 3);
  EXPECT_NE(result.err.find("2 errors"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("did you mean `frames`?"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(output("out")));
  EXPECT_EQ(run({"run", "no_such_scene.toml"}).status, 3);
  EXPECT_EQ(run({"run", small_scene(), "-o", output("out"), "--frames", "0-2"}).status, 3);
  EXPECT_FALSE(fs::exists(output("out")));
}

// Every bad obstacle or vent: exit 3, the key and its place in the scene or on the command line, and what to do.
// Nothing is simulated.
TEST_F(CommandLine, BadCollidersSayWhereWhatAndHowToMend) {
  const std::string scene = small_scene();
  std::ofstream(folder_ / "nan.asc")
      << "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\n0 0 0\n0 nan 0\n0 0 0\n";
  std::ofstream(folder_ / "bad.toml") << std::ifstream(scene).rdbuf()
                                      << "[[collider]]\nmesh = \"assets/bad/empty.obj\"\n";
  const std::string in_file = (folder_ / "bad.toml").string();
  struct Case {
    std::string scene;
    std::vector<std::string> set;
    std::vector<std::string> words;
  };
  const std::vector<Case> cases = {
      {in_file, {}, {"bad.toml:", "collider.1.mesh", "empty.obj"}},
      {scene, {"collider.0.mesh=assets/bad/nan.obj"}, {"collider.0.mesh", "nan.obj", "--set"}},
      {scene, {"collider.0.mesh=" + (folder_ / "nan.asc").string()}, {"collider.0.mesh", "nan.asc", "7"}},
      {scene, {"collider.0.mesh=assets/bad/not_a_mesh.obj"}, {"collider.0.mesh", "not_a_mesh.obj"}},
      {scene,
       {"collider.0.mesh=assets/bad/open_box.obj", "collider.0.mass_kg=5"},
       {"collider.0.mesh", "a rigid body needs a closed mesh"}},
      {scene,
       {"collider.0.mesh=assets/sphere.obj", "collider.0.keyframe=[{ time_s = 1.0 }, { time_s = 0.5 }]"},
       {"collider.0.keyframe", "time_s"}},
      {scene,
       {"emitter=[{ material = \"wax\", position_m = [3.0, -1.0, 0.0], radius_m = 0.2, flow_rate_m3_s = 0.1, "
        "temperature_K = 390 }]"},
       {"emitter.0.position_m", "raise it by"}},
  };
  for (const Case& c : cases) {
    std::vector<std::string> arguments{"run", c.scene, "-o", output("out")};
    for (const std::string& set : c.set) arguments.insert(arguments.end(), {"--set", set});
    const Result result = run(arguments);
    EXPECT_EQ(result.status, 3) << result.err;
    for (const std::string& word : c.words)
      EXPECT_NE(result.err.find(word), std::string::npos) << word << " is not in: " << result.err;
    EXPECT_FALSE(fs::exists(fs::path(output("out")) / "particles" / "particles.0001.vdb"));
  }
}

// What can be made sense of is a warning that says what was done.
TEST_F(CommandLine, OddCollidersAreWarnedOf) {
  const auto warns = [&](const std::vector<std::string>& set, const std::string& words) {
    std::vector<std::string> arguments{"check", small_scene()};
    for (const std::string& s : set) arguments.insert(arguments.end(), {"--set", s});
    const Result result = run(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("collider.0.mesh"), std::string::npos) << result.err;
  };
  warns({"collider.0.mesh=assets/bad/inverted_box.obj", "collider.0.translate_m=[5,0,0]"}, "wound inward");
  warns({"collider.0.mesh=assets/sphere.obj", "collider.0.scale=5000", "collider.0.translate_m=[0,-6000,0]"},
        "enormous");
  warns({"collider.0.mesh=assets/sphere.obj", "collider.0.scale=0.0001", "collider.0.translate_m=[0,-1,0]"}, "tiny");
  warns({"collider.0.mesh=assets/sphere.obj", "collider.0.scale=0.1", "collider.0.translate_m=[0,0.3,0]"},
        "start inside this solid collider");
}

TEST_F(CommandLine, BenchAnswersForPeopleAndMachines) {
  EXPECT_NE(run({"bench", "step", "--particles", "500"}).out.find("million particle-steps/s"), std::string::npos);
  EXPECT_NE(run({"bench", "terms", "--particles", "500", "--json"}).out.find("\"bytes_per_particle\""),
            std::string::npos);
  const std::string shot = run({"bench", "thesis", "--shot", "wall"}).out;
  EXPECT_NE(shot.find("| wall | "), std::string::npos) << shot;
  EXPECT_EQ(shot.find("| candle | "), std::string::npos) << shot;
  EXPECT_NE(run({"bench", "thesis", "--shot", "wall", "--json"}).out.find("\"times_as_fast\""), std::string::npos);
  EXPECT_EQ(run({"bench", "thesis", "--shot", "teapot"}).status, 2);
  EXPECT_EQ(run({"bench"}).status, 2);
  EXPECT_EQ(run({"bench", "--calibrate", "step"}).status, 2);
}

TEST_F(CommandLine, ReportNamesItsCasesAndWhatItNeeds) {
  const Result unknown = run({"report", "chanel", "--quick", "--out", output("report")});
  EXPECT_EQ(unknown.status, 3);
  EXPECT_NE(unknown.err.find("there is no case \"chanel\" (did you mean \"channel\"?); cases are channel, "),
            std::string::npos)
      << unknown.err;
  EXPECT_EQ(run({"report", "channel", "--check"}).status, 2);  // errors are stored of the quick suite alone
  const Result without =
      run({"report", "channel", "--quick", "--out", output("report")}, [] { setenv("PATH", "/nowhere", 1); });
  EXPECT_EQ(without.status, 3);
  EXPECT_NE(without.err.find("gnuplot-nox"), std::string::npos) << without.err;
  EXPECT_FALSE(fs::exists(output("report")));
}

TEST_F(CommandLine, WrongUsageIsExitTwo) {
  EXPECT_EQ(run({}).status, 2);
  EXPECT_EQ(run({"melt"}).status, 2);
  EXPECT_EQ(run({"run"}).status, 2);
  EXPECT_EQ(run({"run", small_scene(), "--no-such-option"}).status, 2);
  EXPECT_EQ(run({"--help"}).status, 0);
  EXPECT_EQ(run({"--version"}).status, 0);
}

TEST_F(CommandLine, AFullDiskIsExitThreeAndFinishedFramesStay) {
  // A file may not grow past 20 kB: the frame's cache cannot be written.
  const Result result = run({"simulate", small_scene(), "-o", output("out")}, [] {
    const rlimit limit{20000, 20000};
    setrlimit(RLIMIT_FSIZE, &limit);
  });
  EXPECT_EQ(result.status, 3) << result.err;
  EXPECT_NE(result.err.find("particles.0001.vdb"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(output("out") + "/particles/particles.0001.vdb")) << "half a file is worse than none";
}

void redirect_to(int fd, const char* path) {
  const int file = open(path, O_WRONLY);
  dup2(file, fd);
  close(file);
}

// What goes to stdout is the result: where it cannot be written the command has failed.
TEST_F(CommandLine, AFullStdoutIsExitThree) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  const std::string bunny = source_folder().string() + "/assets/bunny.obj";
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"info", bunny}, {"scene-reference"}, {"--help"}, {"--version"}}) {
    const Result result = run(arguments, [] { redirect_to(STDOUT_FILENO, "/dev/full"); });
    EXPECT_EQ(result.status, 3) << arguments[0];
    EXPECT_NE(result.err.find("standard output"), std::string::npos) << arguments[0] << ": " << result.err;
    EXPECT_NE(result.err.find("No space left"), std::string::npos) << arguments[0] << ": " << result.err;
    EXPECT_EQ(run(arguments, [] { close(STDOUT_FILENO); }).status, 3) << arguments[0];
  }
}

// What goes to stderr is talk: a shot goes on without it.
TEST_F(CommandLine, AStderrThatCannotBeWrittenStopsNothing) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  close(ends[0]);
  const std::vector<std::function<void()>> ways = {[] { close(STDERR_FILENO); }, [&] { dup2(ends[1], STDERR_FILENO); },
                                                   [] { redirect_to(STDERR_FILENO, "/dev/full"); }};
  for (std::size_t k = 0; k < ways.size(); ++k) {
    // The second run says that it moved the first one aside.
    for (int again = 0; again < 2; ++again)
      EXPECT_EQ(run({"simulate", small_scene(), "-o", output("out"), "--frames", "1"}, ways[k]).status, 0) << k;
    EXPECT_EQ(run({"simulate", small_scene(), "-o", output("out"), "--set", "shot.fps=-1"}, ways[k]).status, 3) << k;
    EXPECT_NO_THROW(read_particles(output("out") + "/particles/particles.0001.vdb")) << k;
  }
  close(ends[1]);
}

// Where nobody asks whether to stop, an interrupt ends the program by itself.
TEST_F(CommandLine, AnInterruptEndsABench) {
  const pid_t child = start({"bench", "pairs", "--particles", "1000000"}, [] { signal(SIGINT, SIG_DFL); });
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  kill(child, SIGINT);
  EXPECT_EQ(finish(child).status, 128 + SIGINT);
}

TEST_F(CommandLine, AFolderThatCannotBeMadeIsExitThree) {
  std::ofstream(output("file")) << "in the way";
  const Result result = run({"run", small_scene(), "-o", output("file") + "/out"});
  EXPECT_EQ(result.status, 3);
  EXPECT_NE(result.err.find("file"), std::string::npos) << result.err;
}

TEST_F(CommandLine, ADivergingRunIsExitFourAndNamesTheCulprit) {
  const Result result = run({"simulate", small_scene(), "-o", output("out"), "--set", "domain.lower_m=[-2,0.1,-2]"});
  EXPECT_EQ(result.status, 4) << result.err;
  EXPECT_NE(result.err.find("left the domain"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("of particle"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("t = "), std::string::npos) << result.err;
  EXPECT_TRUE(fs::exists(output("out") + "/particles/particles.0001.vdb"));
}

TEST_F(CommandLine, AMissingStageIsExitThreeAndSaysWhich) {
  const Result surface = run({"surface", small_scene(), "-o", output("out")});
  EXPECT_EQ(surface.status, 3);
  EXPECT_NE(surface.err.find("particles.0001.vdb"), std::string::npos) << surface.err;
  const Result render = run({"render", small_scene(), "-o", output("out")});
  EXPECT_EQ(render.status, 3);
  EXPECT_NE(render.err.find("surface.0001"), std::string::npos) << render.err;
}

/// Frames that cannot be drawn are named; the others are drawn all the same.
TEST_F(CommandLine, DamagedSurfacesCostTheirOwnFramesOnly) {
  ASSERT_EQ(run({"run", small_scene(), "-o", output("out")}).status, 0);
  const fs::path out = output("out");
  fs::remove_all(out / "frames");
  fs::remove(out / "surface/surface.0002.obj");
  fs::resize_file(out / "surface/surface.0003.vdb", fs::file_size(out / "surface/surface.0003.vdb") / 2);
  const Result result = run({"render", small_scene(), "-o", out.string()});
  EXPECT_EQ(result.status, 3);
  EXPECT_NE(result.err.find("small.toml: frame 2"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("surface.0002.obj"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("surface.0003.vdb"), std::string::npos) << result.err;
  EXPECT_TRUE(fs::exists(out / "frames/frame.0001.png"));
  EXPECT_FALSE(fs::exists(out / "frames/frame.0002.png"));
  EXPECT_FALSE(fs::exists(out / "frames/frame.0003.png"));
  EXPECT_TRUE(fs::exists(out / "frames/frame.0004.png"));
}

/// The same in a run of all stages: what has a surface is drawn before the run ends.
TEST_F(CommandLine, DamagedParticlesCostTheirOwnFrameOnly) {
  ASSERT_EQ(run({"run", small_scene(), "-o", output("out")}).status, 0);
  const fs::path out = output("out");
  fs::remove_all(out / "frames");
  fs::remove_all(out / "surface");
  fs::resize_file(out / "particles/particles.0002.vdb", fs::file_size(out / "particles/particles.0002.vdb") / 2);
  const Result result = run({"run", small_scene(), "-o", out.string(), "--resume"});
  EXPECT_EQ(result.status, 3);
  EXPECT_NE(result.err.find("small.toml: frame 2"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("particles.0002.vdb"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(out / "frames/frame.0002.png"));
  for (const char* frame : {"0001", "0003", "0004"})
    EXPECT_TRUE(fs::exists(out / fmt::format("frames/frame.{}.png", frame))) << frame;
}

TEST_F(CommandLine, PicturesThatCannotBeDrawnNameTheirKeyAndFile) {
  ASSERT_EQ(run({"run", small_scene(), "-o", output("out"), "--frames", "1-2"}).status, 0);
  const auto expect_refusal = [&](const std::vector<std::string>& more, const std::vector<std::string>& texts) {
    std::vector<std::string> arguments{"render", small_scene(), "-o", output("out"), "--frames", "1-2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Result result = run(arguments);
    EXPECT_EQ(result.status, 3) << more.back() << result.err;
    for (const std::string& text : texts)
      EXPECT_NE(result.err.find(text), std::string::npos) << text << ": " << result.err;
  };
  expect_refusal({"--set", "camera.eye_m=[0.0, 0.3, 0.0]"}, {"camera.eye_m", "inside the fluid", "small.toml"});
  expect_refusal({"--set", "camera.width=16000", "--set", "camera.height=16000"}, {"camera.width", "GB of memory"});
  expect_refusal({"--set", "look.material=gold"}, {"look.material", "none of wax"});
  expect_refusal({"--set", "look.crust.plate_m=0.1"}, {"look.crust", "rest_position"});
  expect_refusal({"--set", "environment.kind=image", "--set", "environment.image=no.exr"},
                 {"environment.image", "no.exr"});
  expect_refusal({"--colour-by", "speed"}, {"--colour-by", "--look diagnostic"});
  expect_refusal({"--look", "diagnostic", "--colour-range", "5:1"}, {"--colour-range 5:1", "below"});
  expect_refusal({"--look", "diagnostic", "--resume"}, {"--resume", "leave it out"});
  expect_refusal({"--sheet", "4y3"}, {"--sheet 4y3", "4x3"});
  // Rest positions asked for after the simulation: the caches have none.
  expect_refusal({"--set", "particles.rest_position=true", "--set", "look.crust.plate_m=0.1"},
                 {"look.crust", "simulate again"});
  std::ofstream(folder_ / "lamp.toml") << read_file(small_scene())
                                       << "[[light]]\nposition_m = [0.0, 2.0, 0.0]\nheight_m = 0.0\n";
  const Result lamp = run({"render", output("lamp.toml"), "-o", output("out")});
  EXPECT_EQ(lamp.status, 3);
  EXPECT_NE(lamp.err.find("light.0.height_m"), std::string::npos) << lamp.err;
  EXPECT_EQ(run({"render", small_scene(), "-o", output("out"), "--look", "sketch"}).status, 2);
  EXPECT_EQ(run({"render", small_scene(), "-o", output("out"), "--look", "diagnostic", "--colour-by", "mood"}).status,
            2);
}

TEST_F(CommandLine, DiagnosticPicturesAndSheets) {
  ASSERT_EQ(run({"run", small_scene(), "-o", output("out")}).status, 0);
  const fs::path out = output("out");
  for (const char* quantity : {"temperature", "viscosity", "density", "speed", "pressure"}) {
    const Result result = run({"render", small_scene(), "-o", out.string(), "--look", "diagnostic", "--colour-by",
                               quantity, "--frames", "2-3"});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(read_png(out / fmt::format("diagnostic/{}.0003.png", quantity)).width, 160);
  }
  EXPECT_EQ(
      run({"render", small_scene(), "-o", out.string(), "--look", "diagnostic", "--surface", "wire", "--sheet", "2x2"})
          .status,
      0);
  EXPECT_GT(read_png(out / "sheet.temperature.png").width, 320);
  const Result sheet = run({"render", small_scene(), "-o", out.string(), "--sheet", "3x1"});
  EXPECT_EQ(sheet.status, 0) << sheet.err;
  EXPECT_NE(sheet.out.find("sheet.png"), std::string::npos) << sheet.out;
  EXPECT_GT(read_png(out / "sheet.png").width, 480);
  // A missing attribute.
  std::string cold = read_file(small_scene());
  const auto cut = [&](const std::string& from, const std::string& to) {
    cold.replace(cold.find(from), from.size(), to);
  };
  cut("viscosity = { law = \"smd\", index = 1.0, "
      "yield_stress_Pa = { cold = 4e4, hot = 10.0 }, consistency_Pa_sn = { cold = 4e3, "
      "hot = 100.0 }, jump_number = { cold = 1000, hot = 15 } }",
      "viscosity = { law = \"inviscid\" }");
  cut("heat = {", "#");
  cut("temperature_K = { bottom", "#");
  cut("temperature_K = 290\n[ambient]", "[ambient]");
  cold.erase(cold.find("[ambient]"), cold.find("[camera]") - cold.find("[ambient]"));
  std::ofstream(folder_ / "cold.toml") << cold;
  ASSERT_EQ(run({"simulate", output("cold.toml"), "-o", output("cold"), "--frames", "1"}).status, 0);
  const Result none = run({"render", output("cold.toml"), "-o", output("cold"), "--frames", "1", "--look", "diagnostic",
                           "--colour-by", "viscosity"});
  EXPECT_EQ(none.status, 3);
  EXPECT_NE(none.err.find("--colour-by viscosity"), std::string::npos) << none.err;
}

TEST_F(CommandLine, LayersAndSixteenBitsWhereAskedFor) {
  const Result result = run({"run", small_scene(), "-o", output("out"), "--frames", "1-2", "--set", "render.exr=true",
                             "--set", "render.png_bits=16"});
  ASSERT_EQ(result.status, 0) << result.err;
  const LayeredImage image = read_exr(output("out") + "/frames/frame.0002.exr");
  EXPECT_EQ(image.width, 160);
  for (const char* name : {"R", "A", "albedo.G", "depth.Z", "normal.X", "position.Y", "temperature.T", "velocity.Z"})
    EXPECT_TRUE(std::any_of(image.channels.begin(), image.channels.end(), [&](const ImageChannel& c) {
      return c.name == name;
    })) << name;
  EXPECT_EQ(read_file(output("out") + "/frames/frame.0002.png")[24], 16);
}

// The bytes of the report are all that a stage wrote for the frame, checkpoints left out.
TEST_F(CommandLine, TheReportCountsAllBytes) {
  std::ofstream(folder_ / "ball.toml") << read_file(small_scene())
                                       << "[[collider]]\nmesh = \"assets/sphere.obj\"\nscale = 0.1\n"
                                          "translate_m = [1.0, 1.0, 0.0]\nmass_kg = 5.0\n";
  const Result result =
      run({"run", output("ball.toml"), "-o", output("out"), "--frames", "1-2", "--set", "render.exr=true"});
  ASSERT_EQ(result.status, 0) << result.err;
  const fs::path out = output("out");
  const auto report = nlohmann::json::parse(read_file(out / "run.json"));
  for (int frame = 1; frame <= 2; ++frame) {
    const auto bytes = [&](std::initializer_list<const char*> names) {
      std::uintmax_t n = 0;
      for (const char* name : names) n += fs::file_size(out / fmt::format(fmt::runtime(name), frame));
      return n;
    };
    const auto& entry = report["frames"][static_cast<std::size_t>(frame) - 1];
    EXPECT_EQ(entry["simulate"]["bytes"], bytes({"particles/particles.{:04}.vdb", "bodies/bodies.{:04}.json"}));
    EXPECT_EQ(entry["surface"]["bytes"], bytes({"surface/surface.{:04}.obj", "surface/surface.{:04}.vdb"}));
    EXPECT_EQ(entry["render"]["bytes"], bytes({"frames/frame.{:04}.png", "frames/frame.{:04}.exr"}));
  }
}

TEST_F(CommandLine, CheckAndInfoAnswer) {
  const Result check = run({"check", small_scene()});
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_NE(check.out.find("time step"), std::string::npos) << check.out;
  ASSERT_EQ(run({"simulate", small_scene(), "-o", output("out"), "--frames", "1"}).status, 0);
  const Result info = run({"info", output("out") + "/particles/particles.0001.vdb"});
  EXPECT_EQ(info.status, 0) << info.err;
  EXPECT_NE(info.out.find("temperature"), std::string::npos) << info.out;
  const Result mesh = run({"info", source_folder().string() + "/assets/bunny.obj"});
  EXPECT_NE(mesh.out.find("closed     yes"), std::string::npos) << mesh.out;
  EXPECT_NE(mesh.out.find("194.288"), std::string::npos) << mesh.out;
  EXPECT_EQ(run({"info", small_scene()}).status, 3);
  fs::copy_file(source_folder() / "assets/bunny.obj", folder_ / "BUNNY.OBJ");
  EXPECT_EQ(run({"info", output("BUNNY.OBJ")}).out, mesh.out);
  write_obj(folder_ / "empty.obj", {});
  const Result empty = run({"info", output("empty.obj")});
  EXPECT_EQ(empty.status, 0) << empty.err;
  EXPECT_NE(empty.out.find("vertices   0\n"), std::string::npos) << empty.out;
}

// Particles that come and go: caches, checkpoints, surfaces, pictures and the report with another number of them in
// every frame.
TEST_F(CommandLine, AVentPoursTheSameOnAnyThreadsAndAfterAResume) {
  const fs::path scene = folder_ / "pour.toml";
  std::ofstream(scene) << R"(
[shot]
name = "pour"
frames = 7
fps = 12
[particles]
spacing_m = 0.05
[solver]
sound_speed_m_s = 20.0
[[material]]
name = "syrup"
density_kg_m3 = 1300
viscosity = { law = "newtonian", viscosity_Pa_s = 15.0 }
[[emitter]]
material = "syrup"
position_m = [0.0, 0.6, 0.0]
direction = [0.0, -1.0, 0.0]
radius_m = 0.12
flow_rate_m3_s = 0.06
start_s = 0.1
end_s = 0.45
[[collider]]
mesh = "ground"
[[outflow]]
lower_m = [0.1, -1.0, -2.0]
upper_m = [2.0, 1.0, 2.0]
[camera]
eye_m = [1.0, 1.0, 3.0]
target_m = [0.0, 0.2, 0.0]
width = 80
height = 45
)";
  const auto with = [&](const char* out, const char* threads, std::vector<std::string> more) {
    std::vector<std::string> arguments = {"run", scene.string(), "-o", output(out), "--threads", threads};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Result result = run(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
  };
  with("one", "1", {});
  with("two", "2", {});
  with("cut", "1", {"--frames", "1-4"});
  with("cut", "1", {"--resume"});
  for (const char* other : {"two", "cut"}) {
    expect_same_files(output("one") + "/particles", output(other) + "/particles", 7);
    expect_same_files(output("one") + "/surface", output(other) + "/surface", 14);
    expect_same_files(output("one") + "/frames", output(other) + "/frames", 7);
  }
  const auto report = nlohmann::json::parse(read_file(fs::path(output("cut")) / "run.json"));
  std::vector<std::int32_t> ids;
  for (int frame = 1; frame <= 7; ++frame) {
    const auto& entry = report["frames"][frame - 1]["simulate"];
    const auto& account = entry["mass_account_kg"];
    const double added = account["added"], poured = entry["poured_m3"];
    EXPECT_LE(std::abs(account["imbalance"].get<double>()), 1e-12 * std::max(1.0, added)) << "frame " << frame;
    EXPECT_NEAR(added, 1300.0 * poured, 1e-9);
    const double due = 0.06 * std::clamp((frame - 1) / 12.0 - 0.1, 0.0, 0.35);
    EXPECT_NEAR(poured, due, 0.51 * 0.12 * 0.12 * 3.1416 * 0.05) << "frame " << frame;
    const ParticleFrame particles =
        read_particles(fs::path(output("one")) / fmt::format("particles/particles.{:04}.vdb", frame));
    EXPECT_EQ(static_cast<double>(particles.size()), entry["particles"].get<double>());
    EXPECT_TRUE(std::adjacent_find(particles.id.begin(), particles.id.end(), std::greater_equal<>()) ==
                particles.id.end());
    ids = particles.id;
  }
  EXPECT_EQ(report["frames"][0]["simulate"]["particles"], 0);
  EXPECT_GT(report["frames"][6]["simulate"]["mass_account_kg"]["removed"].get<double>(), 0.0);
  EXPECT_GE(ids.back(), static_cast<std::int32_t>(ids.size())) << "ids of particles that are gone are not given again";
  const Result check = run({"check", scene.string()});
  EXPECT_NE(check.out.find("particles   0 at the start, 168 at the end"), std::string::npos) << check.out;
}

}  // namespace
}  // namespace smelt
