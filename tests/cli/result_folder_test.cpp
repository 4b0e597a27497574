// What a folder with an earlier result in it, or with files of the user's own, is safe from.

#include "io/atomic_file.h"
#include "tests/cli/command_line.h"
#include "tests/source_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>
#include <vector>

namespace smelt {
namespace {

class ResultFolder : public CommandLine {};

TEST_F(ResultFolder, ResumingAnotherSceneIsRefused) {
  ASSERT_EQ(run({"simulate", small_scene(), "-o", output("out"), "--frames", "1"}).status, 0);
  const Result result =
      run({"simulate", small_scene(), "-o", output("out"), "--resume", "--set", "material.0.density_kg_m3=1000"});
  EXPECT_EQ(result.status, 3);
  EXPECT_NE(result.err.find("another scene"), std::string::npos) << result.err;
}

// A scene.toml is nobody's result: the user's own folder is neither written over nor moved.
TEST_F(ResultFolder, AFolderWithTheUsersOwnFilesStaysWhereItIs) {
  const fs::path shot = folder_ / "shot";
  fs::create_directory(shot);
  fs::copy_file(small_scene(), shot / "scene.toml");
  const auto in_it = [&] { ASSERT_EQ(chdir(shot.c_str()), 0); };
  for (const char* stage : {"run", "simulate"})
    for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--resume"}}) {
      std::vector<std::string> arguments = {stage, "scene.toml", "-o", ".", "--frames", "1"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      const Result result = run(arguments, in_it);
      EXPECT_EQ(result.status, 3);
      EXPECT_NE(result.err.find("scene.toml: is in the way and no run of smelt wrote it"), std::string::npos)
          << result.err;
    }
  EXPECT_EQ(read_file(shot / "scene.toml"), read_file(small_scene()));
  EXPECT_FALSE(fs::exists(folder_ / "shot.1"));

  fs::rename(shot / "scene.toml", shot / "shot.toml");
  ASSERT_EQ(run({"simulate", "shot.toml", "-o", ".", "--frames", "1"}, in_it).status, 0);
  const Result again = run({"simulate", "shot.toml", "-o", ".", "--frames", "1"}, in_it);
  EXPECT_EQ(again.status, 3);
  EXPECT_NE(again.err.find("would be moved aside, but you are in it"), std::string::npos) << again.err;
  const Result outside = run({"simulate", (shot / "shot.toml").string(), "-o", shot.string(), "--frames", "1"});
  EXPECT_EQ(outside.status, 3);
  EXPECT_NE(outside.err.find("would be moved aside, but the scene is in it"), std::string::npos) << outside.err;
  EXPECT_TRUE(fs::exists(shot / "particles" / "particles.0001.vdb"));
  EXPECT_FALSE(fs::exists(folder_ / "shot.1"));
}

TEST_F(ResultFolder, ARunThatIsRefusedLeavesTheEarlierResultAlone) {
  ASSERT_EQ(run({"simulate", small_scene(), "-o", output("out"), "--frames", "1"}).status, 0);
  const Result result = run({"run", small_scene(), "-o", output("out"), "--set", "body.0.stand_at_y_m=-5"});
  EXPECT_EQ(result.status, 3);
  EXPECT_NE(result.err.find("below the ground"), std::string::npos) << result.err;
  EXPECT_TRUE(fs::exists(output("out") + "/particles/particles.0001.vdb"));
  EXPECT_FALSE(fs::exists(output("out.1")));
}

// Starting over on top of frames would leave surfaces and pictures of the earlier ones beside new particles.
TEST_F(ResultFolder, ResumingWithoutCheckpointsIsRefusedWhereFramesWouldBeLost) {
  ASSERT_EQ(run({"simulate", small_scene(), "-o", output("out"), "--frames", "1"}).status, 0);
  const fs::path out = output("out");
  fs::remove_all(out / "checkpoint");
  const auto resume = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = {"simulate", small_scene(), "-o", out.string(), "--frames", "1-2", "--resume"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  };
  const Result other = resume({"--set", "material.0.density_kg_m3=1000"});
  EXPECT_EQ(other.status, 3);
  EXPECT_NE(other.err.find("another scene"), std::string::npos) << other.err;
  // Cut off in the first frame: that is made again.
  EXPECT_EQ(resume({}).status, 0);
  fs::remove_all(out / "checkpoint");
  const std::string kept = read_file(out / "particles/particles.0002.vdb");
  const Result later = resume({});
  EXPECT_EQ(later.status, 3);
  EXPECT_NE(later.err.find("no checkpoints"), std::string::npos) << later.err;
  EXPECT_NE(later.err.find("particles.0002.vdb"), std::string::npos) << later.err;
  EXPECT_TRUE(read_file(out / "particles/particles.0002.vdb") == kept);
  // Surfaces and pictures need no checkpoint.
  EXPECT_EQ(run({"surface", small_scene(), "-o", out.string(), "--frames", "1-2", "--resume"}).status, 0);
}

// A scene in several files is its vertices too, wherever they lie.
TEST_F(ResultFolder, ResumingWithOtherBuffersOfAMeshIsRefused) {
  const std::array<float, 12> corners = {0, 0, 0, 0.3f, 0, 0, 0, 0.3f, 0, 0, 0, 0.3f};
  const auto write_buffer = [&](float scale) {
    std::ofstream file(folder_ / "body.bin", std::ios::binary);
    for (const float x : corners) {
      const float scaled = scale * x;
      file.write(reinterpret_cast<const char*>(&scaled), sizeof scaled);
    }
    const std::array<std::uint16_t, 12> faces = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    file.write(reinterpret_cast<const char*>(faces.data()), sizeof faces);
  };
  write_buffer(1.0f);
  std::ofstream(folder_ / "body.gltf") << R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
"buffers": [{"uri": "body.bin", "byteLength": 72}],
"bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [0.3, 0.3, 0.3]},
{"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}]})";
  const std::vector<std::string> arguments = {
      "simulate",    small_scene(),    "-o",
      output("out"), "--set",          "body.0.mesh=" + (folder_ / "body.gltf").string(),
      "--set",       "body.0.scale=1", "--frames",
      "1",           "--resume"};
  const Result first = run(arguments);
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_EQ(run(arguments).status, 0);
  write_buffer(1.1f);
  const Result other = run(arguments);
  EXPECT_EQ(other.status, 3);
  EXPECT_NE(other.err.find("other meshes"), std::string::npos) << other.err;
}

TEST_F(ResultFolder, ADamagedCheckpointFallsBackToTheOneBefore) {
  ASSERT_EQ(run({"simulate", small_scene(), "-o", output("whole")}).status, 0);
  ASSERT_EQ(run({"simulate", small_scene(), "-o", output("out"), "--frames", "1-3"}).status, 0);
  const fs::path newest = output("out") + "/checkpoint/checkpoint.0003.bin";
  fs::resize_file(newest, fs::file_size(newest) / 2);
  const Result result = run({"simulate", small_scene(), "-o", output("out"), "--resume"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("trying the one before"), std::string::npos) << result.err;
  expect_same_files(output("whole") + "/particles", output("out") + "/particles", 4);
}

}  // namespace
}  // namespace smelt
