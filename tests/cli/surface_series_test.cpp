// `smelt surface` on particle files without a scene, and what `smelt info` says of the results.

#include "io/mesh_import.h"
#include "io/obj.h"
#include "io/particles_vdb.h"
#include "tests/cli/command_line.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sys/resource.h>

namespace smelt {
namespace {

constexpr double spacing = 0.05;

std::vector<Vec3> ball(double radius_over_spacing) {
  std::vector<Vec3> x;
  const double n = std::ceil(radius_over_spacing);
  for (double k = -n; k <= n; ++k)
    for (double j = -n; j <= n; ++j)
      for (double i = -n; i <= n; ++i)
        if (Vec3(i, j, k).norm() < radius_over_spacing) x.push_back(spacing * Vec3(i, j, k));
  return x;
}

class SurfaceSeries : public CommandLine {
 protected:
  /// cloud.NNNN.csv with a velocity and a temperature.
  std::string write_csv(int frame, const std::vector<Vec3>& positions, const std::string& last_line = "") {
    const std::string path = output(fmt::format("cloud.{:04}.csv", frame).c_str());
    std::ofstream file(path);
    file << "x,y,z,vx,vy,vz,temperature,colour\n";
    for (const Vec3& x : positions)
      file << fmt::format("{},{},{},1,0,-2,{},7\n", x[0], x[1], x[2], 350.0 + 100.0 * x[1]);
    file << last_line;
    return path;
  }
  std::string write(const char* name, const std::string& text) {
    std::ofstream(output(name)) << text;
    return output(name);
  }
  std::string pattern() { return output("cloud.####.csv"); }

  void expect_refused(const std::vector<std::string>& arguments, const std::vector<std::string>& said) {
    const Result result = run(arguments);
    EXPECT_EQ(result.status, 3) << result.out << result.err;
    for (const std::string& text : said)
      EXPECT_NE(result.err.find(text), std::string::npos) << text << "\nis not in\n" << result.err;
    EXPECT_FALSE(fs::exists(output("out") + "/surface/surface.0001.obj"));
  }
  void write_cache(const char* name, const std::vector<Vec3>& positions) {
    ParticleFrame frame;
    frame.position = positions;
    frame.velocity.assign(positions.size(), Vec3f(0.0f, 1.0f, 0.0f));
    frame.density.assign(positions.size(), 1000.0f);
    for (std::size_t i = 0; i < positions.size(); ++i) frame.id.push_back(static_cast<std::int32_t>(i));
    frame.mass = 1000.0 * spacing * spacing * spacing;
    frame.spacing = spacing;
    frame.smoothing_length = 1.2 * spacing;
    frame.frame = 1;
    write_particles(output(name), frame);
  }
};

// Two machines make their shares of the frames in one folder: neither forgets what the other made.
TEST_F(SurfaceSeries, TwoAtATimeKeepWhatTheOtherMade) {
  for (int frame = 1; frame <= 8; ++frame) write_csv(frame, ball(6.0));
  const auto part = [&](const char* frames) {
    return start({"surface", pattern(), "-o", output("out"), "--resume", "--frames", frames});
  };
  const pid_t first = part("1-4"), second = part("5-8");
  EXPECT_EQ(finish(first).status, 0);
  EXPECT_EQ(finish(second).status, 0);
  const std::string settings = read_file(output("out") + "/surface/settings.toml");
  EXPECT_EQ(settings.substr(0, settings.find('\n')), "# frames = 1 2 3 4 5 6 7 8");
  const Result again = run({"surface", pattern(), "-o", output("out"), "--resume"});
  EXPECT_NE(again.out.find("0 made, 8 kept"), std::string::npos) << again.out;
}

TEST_F(SurfaceSeries, CloudsOfAnotherSolverBecomeSurfaces) {
  for (int frame = 3; frame <= 6; ++frame) write_csv(frame, ball(6.0));
  const Result result = run({"surface", pattern(), "-o", output("out"), "--frames", "4-6", "--set", "surface.ply=true",
                             "--set", "surface.vertex_colours=true", "--set", "surface.fog_volume=true"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("estimated from " + output("cloud.0003.csv")), std::string::npos) << result.err;
  EXPECT_NE(result.out.find("3 made, 0 kept"), std::string::npos) << result.out;
  EXPECT_FALSE(fs::exists(output("out") + "/surface/surface.0003.obj"));
  const double volume = static_cast<double>(ball(6.0).size()) * spacing * spacing * spacing;
  const TriangleMesh obj = import_mesh(output("out") + "/surface/surface.0005.obj"),
                     ply = import_mesh(output("out") + "/surface/surface.0005.ply");
  EXPECT_NEAR(compute_volume(obj) / volume, 1.0, 0.05);
  EXPECT_EQ(obj.triangles.size(), ply.triangles.size());

  const Result info = run({"info", output("out") + "/surface/surface.0005.ply"});
  for (const char* line : {"components 1", "closed     yes", "manifold   yes", "oriented   yes", "volume     0."})
    EXPECT_NE(info.out.find(line), std::string::npos) << info.out;
  const Result grids = run({"info", output("out") + "/surface/surface.0005.vdb"});
  for (const char* line :
       {"grid       surface\ntype       float, level set", "grid       v\ntype       vec3s", "grid       temperature",
        "grid       density\ntype       float, fog volume", "creator    smelt", "frame      5", "half width"})
    EXPECT_NE(grids.out.find(line), std::string::npos) << line << grids.out;
  const Result cloud = run({"info", output("cloud.0003.csv")});
  EXPECT_NE(cloud.out.find(fmt::format("particles  {}", ball(6.0).size())), std::string::npos) << cloud.out;
  EXPECT_NE(cloud.out.find("unused     colour"), std::string::npos) << cloud.out;

  // Done frames are kept with --resume, unless settings changed.
  EXPECT_NE(run({"surface", pattern(), "-o", output("out"), "--frames", "3-6", "--resume", "--set", "surface.ply=true",
                 "--set", "surface.vertex_colours=true", "--set", "surface.fog_volume=true"})
                .out.find("1 made, 3 kept"),
            std::string::npos);
  EXPECT_NE(run({"surface", pattern(), "-o", output("out"), "--resume"}).out.find("4 made, 0 kept"), std::string::npos);
}

TEST_F(SurfaceSeries, OtherFormatsAndOwnCaches) {
  std::string xyz,
      ply = fmt::format(
          "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
          "end_header\n",
          ball(5.0).size());
  for (const Vec3& x : ball(5.0)) {
    xyz += fmt::format("{} {} {}\n", x[0], x[1], x[2]);
    ply += fmt::format("{} {} {}\n", x[0], x[1], x[2]);
  }
  write_cache("particles.0001.vdb", ball(5.0));
  for (const std::string& name : {write("a.xyz", xyz), write("a.ply", ply), output("particles.0001.vdb")}) {
    const Result result = run({"surface", name, "-o", output("out"), "--spacing_m", "0.05"});
    ASSERT_EQ(result.status, 0) << result.err;
    const double volume = static_cast<double>(ball(5.0).size()) * spacing * spacing * spacing;
    EXPECT_NEAR(compute_volume(read_obj(output("out") + "/surface/surface.0001.obj").mesh) / volume, 1.0, 0.06) << name;
  }
}

TEST_F(SurfaceSeries, AMissingFrameIsSaidLoudly) {
  for (const int frame : {1, 2, 4}) write_csv(frame, ball(4.0));
  expect_refused({"surface", pattern(), "-o", output("out")}, {"cloud.0003.csv", "missing"});
  expect_refused({"surface", pattern(), "-o", output("out"), "--frames", "4-5"}, {"cloud.0005.csv", "missing"});
  expect_refused({"surface", output("none.####.csv"), "-o", output("out")}, {"none.####.csv"});
  expect_refused({"surface", output("none.csv"), "-o", output("out")}, {"none.csv"});
  expect_refused(
      {"surface", output("cloud.0001.csv"), output("cloud.0002.csv"), "-o", output("out"), "--frames", "2-4"},
      {"frame 3 is missing"});
}

TEST_F(SurfaceSeries, BadParticlesAreNamedWithTheirFile) {
  const auto surface = [&](const std::string& name) {
    return std::vector<std::string>{"surface", name, "-o", output("out")};
  };
  const std::string n = fmt::format("particle {}", ball(3.0).size());
  expect_refused(surface(write_csv(1, ball(3.0), "0,nan,0,0,0,0,300,7\n")), {"cloud.0001.csv", n, "finite"});
  expect_refused(surface(write_csv(1, ball(3.0), "0,0,-inf,0,0,0,300,7\n")), {"cloud.0001.csv", n, "finite"});
  expect_refused(surface(write_csv(1, ball(3.0), "0,0,zero,0,0,0,300,7\n")), {"cloud.0001.csv", n, "zero"});
  expect_refused(surface(write_csv(1, ball(3.0), "0,0\n")), {"cloud.0001.csv", n, "2 numbers"});
  expect_refused(surface(write_csv(1, {})), {"cloud.0001.csv", "no particles"});
  expect_refused(surface(write_csv(1, {Vec3::Zero()})), {"cloud.0001.csv", "1 particle is too few", "--spacing_m"});
  expect_refused(surface(write_csv(1, std::vector<Vec3>(50, Vec3(1, 2, 3)))), {"cloud.0001.csv", "same place"});
  auto with_spacing = surface(write_csv(1, std::vector<Vec3>(50, Vec3(1, 2, 3))));
  with_spacing.insert(with_spacing.end(), {"--spacing_m", "0.05"});
  expect_refused(with_spacing, {"cloud.0001.csv", "all 50 particles are at one place"});
  expect_refused(
      surface(
          write("a.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 9\nproperty float x\nend_header\n1234")),
      {"a.ply", "truncated"});
  expect_refused(surface(write("a.csv", "a,b\n1,2\n")), {"a.csv", "x, y, z", "a, b"});
  expect_refused(surface(write("a.abc", "1")), {"a.abc", ".csv"});
}

TEST_F(SurfaceSeries, BadCachesAreNamed) {
  write_cache("particles.0001.vdb", ball(4.0));
  const std::string cache = output("particles.0001.vdb");
  std::string bytes = read_file(cache);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
  expect_refused({"surface", write("damaged.vdb", bytes), "-o", output("out")}, {"damaged.vdb", "damaged"});
  expect_refused({"surface", write("short.vdb", bytes.substr(0, bytes.size() / 3)), "-o", output("out")},
                 {"short.vdb", "damaged"});
  write_cache("empty.vdb", {});
  expect_refused({"surface", output("empty.vdb"), "-o", output("out")}, {"empty.vdb", "no particles"});
  write_cache("place.vdb", std::vector<Vec3>(20, Vec3(1, 2, 3)));
  expect_refused({"surface", output("place.vdb"), "-o", output("out")}, {"place.vdb", "one place"});

  // One particle of a cache, which says how large it is, is a drop.
  write_cache("one.vdb", {Vec3(1, 2, 3)});
  ASSERT_EQ(run({"surface", output("one.vdb"), "-o", output("drop")}).status, 0);
  EXPECT_NEAR(compute_volume(read_obj(output("drop") + "/surface/surface.0001.obj").mesh), spacing * spacing * spacing,
              0.3 * spacing * spacing * spacing);
}

TEST_F(SurfaceSeries, WhatCannotBeIsSaidBeforeItStarts) {
  write_cache("particles.0001.vdb", ball(4.0));
  const std::string cache = output("particles.0001.vdb");
  // Drops far from one another, in cells of a tenth of a spacing: 70 GB. Said at once, not when the memory is gone.
  std::vector<Vec3> far;
  for (int i = 0; i < 4000; ++i) far.push_back(Vec3(1.7 * (i % 20), 1.7 * (i / 20 % 20), 1.7 * (i / 400)));
  write_cache("far.vdb", far);
  const Result large = run({"surface", output("far.vdb"), "-o", output("out"), "--set", "surface.cell_over_spacing=0.1",
                            "--set", "surface.kernel_over_spacing=3"},
                           [] {
                             const rlimit limit{4000000000, 4000000000};
                             setrlimit(RLIMIT_AS, &limit);
                           });
  EXPECT_EQ(large.status, 3) << large.err;
  EXPECT_NE(large.err.find("far.vdb"), std::string::npos) << large.err;
  EXPECT_NE(large.err.find("allowed are 4 GB"), std::string::npos) << large.err;
  expect_refused({"surface", cache, "-o", output("out"), "--attributes", "v,salinity"},
                 {"particles.0001.vdb", "salinity", "v"});
  expect_refused({"surface", cache, "-o", output("out"), "--attributes", "temperature"},
                 {"particles.0001.vdb", "temperature"});
  expect_refused({"surface", cache, "-o", output("out"), "--set", "surface.vertex_colours=true"},
                 {"particles.0001.vdb", "temperature"});
  expect_refused({"surface", cache, "-o", output("out"), "--set", "surface.iso_valeu=0.4"}, {"iso_value"});
}

std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::array<char, 4096> buffer;
  for (std::size_t n; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) text.append(buffer.data(), n);
  return pclose(pipe) == 0 ? text : "failed: " + text;
}

/// OpenVDB's own reader, where libopenvdb-tools is installed, as it is in .ci/run.
TEST_F(SurfaceSeries, OpenVdbsToolReadsTheGrids) {
  if (std::system("command -v vdb_print >/dev/null") != 0) GTEST_SKIP() << "vdb_print is not installed";
  write_csv(7, ball(6.0));
  ASSERT_EQ(run({"surface", pattern(), "-o", output("out"), "--set", "surface.fog_volume=true"}).status, 0);
  const std::string text = output_of("vdb_print -l -m " + output("out") + "/surface/surface.0007.vdb");
  for (const char* said : {"surface", "level set", "temperature", "density", "fog volume", "smelt"})
    EXPECT_NE(text.find(said), std::string::npos) << said << " is not in\n" << text;
}

}  // namespace
}  // namespace smelt
