// The program as a user meets it: the real binary, its files, its exit codes.

#include "io/atomic_file.h"
#include "io/obj.h"
#include "io/particles_vdb.h"
#include "io/png.h"
#include "tests/cli/command_line.h"
#include "tests/source_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
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
  const Result result = run({"run", small_scene(), "-o", output("out"), "--set", "shot.framse=3", "--set", "particles.count=-1"});
  EXPECT_EQ(result.status, 3);
  EXPECT_NE(result.err.find("2 errors"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("did you mean `frames`?"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(output("out")));
  EXPECT_EQ(run({"run", "no_such_scene.toml"}).status, 3);
  EXPECT_EQ(run({"run", small_scene(), "-o", output("out"), "--frames", "0-2"}).status, 3);
  EXPECT_FALSE(fs::exists(output("out")));
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

TEST_F(CommandLine, ResumingAnotherSceneIsRefused) {
  ASSERT_EQ(run({"simulate", small_scene(), "-o", output("out"), "--frames", "1"}).status, 0);
  const Result result = run({"simulate", small_scene(), "-o", output("out"), "--resume", "--set", "material.0.density_kg_m3=1000"});
  EXPECT_EQ(result.status, 3);
  EXPECT_NE(result.err.find("another scene"), std::string::npos) << result.err;
}

TEST_F(CommandLine, ADamagedCheckpointFallsBackToTheOneBefore) {
  ASSERT_EQ(run({"simulate", small_scene(), "-o", output("whole")}).status, 0);
  ASSERT_EQ(run({"simulate", small_scene(), "-o", output("out"), "--frames", "1-3"}).status, 0);
  const fs::path newest = output("out") + "/checkpoint/checkpoint.0003.bin";
  fs::resize_file(newest, fs::file_size(newest) / 2);
  const Result result = run({"simulate", small_scene(), "-o", output("out"), "--resume"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("trying the one before"), std::string::npos) << result.err;
  expect_same_files(output("whole") + "/particles", output("out") + "/particles", 4);
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
}

// Particles that come and go: caches, checkpoints, surfaces, pictures and the report with another number of them in every frame.
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
    const ParticleFrame particles = read_particles(fs::path(output("one")) / fmt::format("particles/particles.{:04}.vdb", frame));
    EXPECT_EQ(static_cast<double>(particles.size()), entry["particles"].get<double>());
    EXPECT_TRUE(std::adjacent_find(particles.id.begin(), particles.id.end(), std::greater_equal<>()) == particles.id.end());
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
