#include "io/particle_cloud.h"

#include "core/error.h"

#include <gtest/gtest.h>

#include <fstream>
#include <unistd.h>

namespace smelt {
namespace {

std::filesystem::path write(const std::string& name, const std::string& bytes) {
  const auto path = std::filesystem::path(testing::TempDir()) / ("cloud_" + std::to_string(::getpid()) + "_" + name);
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

std::string message_of(const std::string& name, const std::string& bytes) {
  try {
    read_particle_cloud(write(name, bytes));
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(ParticleCloud, CsvColumnsByName) {
  const ParticleCloud c = read_particle_cloud(write(
      "a.csv",
      "# made by hand\n\"Temperature\";z;y;x;id;vx;vy;vz\r\n310;3;2;1;0;.1;.2;.3\r\n\n320;-3e-1;+2;1;1;4;5;6\r\n"));
  EXPECT_EQ(c.position, (std::vector<Vec3>{Vec3(1, 2, 3), Vec3(1, 2, -0.3)}));
  EXPECT_EQ(c.velocity, (std::vector<Vec3f>{Vec3f(0.1f, 0.2f, 0.3f), Vec3f(4, 5, 6)}));
  EXPECT_EQ(c.temperature, (std::vector<float>{310, 320}));
  EXPECT_TRUE(c.density.empty());
  EXPECT_EQ(c.unused, (std::vector<std::string>{"id"}));
}

TEST(ParticleCloud, CsvAsParaViewWritesIt) {
  const ParticleCloud c = read_particle_cloud(
      write("paraview.csv", "velocity:0,velocity:1,velocity:2,Points:0,Points:1,Points:2\n1,2,3,4,5,6\n"));
  EXPECT_EQ(c.position, (std::vector<Vec3>{Vec3(4, 5, 6)}));
  EXPECT_EQ(c.velocity, (std::vector<Vec3f>{Vec3f(1, 2, 3)}));
}

TEST(ParticleCloud, CsvWithAByteOrderMark) {
  const ParticleCloud c = read_particle_cloud(write("mark.CSV", "\xef\xbb\xbfx,y,z\n1,2,3\n"));
  EXPECT_EQ(c.position, (std::vector<Vec3>{Vec3(1, 2, 3)}));
}

TEST(ParticleCloud, XyzIsThreeNumbersALine) {
  EXPECT_EQ(read_particle_cloud(write("a.xyz", "1 2 3\n\t4  5 6\n# end\n")).position,
            (std::vector<Vec3>{Vec3(1, 2, 3), Vec3(4, 5, 6)}));
  EXPECT_NE(message_of("four.xyz", "1 2 3\n1 2 3 4\n").find("four.xyz:2: particle 1 has 4 numbers"), std::string::npos);
}

TEST(ParticleCloud, PlyInBothByteOrders) {
  const auto header = [](const char* order) {
    return std::string("ply\nformat ") + order +
           " 1.0\nelement vertex 1\nproperty double x\nproperty float y\nproperty short z\nproperty float density\n"
           "end_header\n";
  };
  // 1.0, 2.0f, 3, 1000.0f
  const std::string big("\x3f\xf0\0\0\0\0\0\0\x40\0\0\0\0\x03\x44\x7a\0\0", 18),
      little("\0\0\0\0\0\0\xf0\x3f\0\0\0\x40\x03\0\0\0\x7a\x44", 18);
  for (const ParticleCloud& c : {read_particle_cloud(write("big.ply", header("binary_big_endian") + big)),
                                 read_particle_cloud(write("little.ply", header("binary_little_endian") + little)),
                                 read_particle_cloud(write("ascii.ply", header("ascii") + "+1.0 2 +3e0 1000\n"))}) {
    EXPECT_EQ(c.position, (std::vector<Vec3>{Vec3(1, 2, 3)}));
    EXPECT_EQ(c.density, (std::vector<float>{1000}));
  }
  EXPECT_NE(message_of("cut.ply", header("binary_big_endian") + big.substr(1)).find("truncated"), std::string::npos);
  EXPECT_NE(message_of("cut.ply", header("ascii") + "1 2 3").find("truncated"), std::string::npos);
}

TEST(ParticleCloud, NamesTheParticleAtFault) {
  EXPECT_NE(message_of("nan.csv", "x,y,z\n0,0,0\n0,nan,0\n").find("particle 1 is (0, nan, 0)"), std::string::npos);
  EXPECT_NE(message_of("density.csv", "x,y,z,density\n0,0,0,0\n").find("particle 0"), std::string::npos);
  EXPECT_NE(message_of("text.csv", "x,y,z\n0,0,none\n").find("text.csv:2"), std::string::npos);
  EXPECT_NE(message_of("part.csv", "x,y,z,vx\n0,0,0,1\n").find("no column `vy`"), std::string::npos);
  EXPECT_NE(message_of("empty.csv", "x,y,z\n").find("no particles"), std::string::npos);
  EXPECT_NE(message_of("names.csv", "a,b\n1,2\n").find("it has a, b"), std::string::npos);
}

}  // namespace
}  // namespace smelt
