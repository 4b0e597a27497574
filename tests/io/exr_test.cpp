#include "io/exr.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/png.h"
#include "io/radiance_hdr.h"

#include <gtest/gtest.h>

#include <fstream>
#include <unistd.h>

namespace smelt {
namespace {

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / ("exr_" + std::to_string(::getpid()) + "_" + name);
}

LayeredImage some_layers() {
  LayeredImage image{3, 2, {}};
  for (const char* name : {"R", "G", "B", "A", "depth.Z"})
    image.channels.push_back({name, {0.0f, 0.5f, 1.0f, 2.0f, 1e4f, 123456.7f}});
  return image;
}

TEST(Exr, ReadsBackColoursAsHalvesAndTheRestExactly) {
  write_exr(temporary("layers.exr"), some_layers());
  const LayeredImage back = read_exr(temporary("layers.exr"));
  EXPECT_EQ(back.width, 3);
  EXPECT_EQ(back.height, 2);
  ASSERT_EQ(back.channels.size(), 5U);
  for (const ImageChannel& channel : back.channels) {
    if (channel.name == "depth.Z")
      EXPECT_EQ(channel.values, some_layers().channels[4].values);
    else
      EXPECT_EQ(channel.values, (std::vector<float>{0.0f, 0.5f, 1.0f, 2.0f, 1e4f, 65504.0f})) << channel.name;
  }
}

TEST(Exr, SameImageSameBytes) {
  write_exr(temporary("a.exr"), some_layers());
  write_exr(temporary("b.exr"), some_layers());
  EXPECT_EQ(read_file(temporary("a.exr")), read_file(temporary("b.exr")));
}

TEST(Exr, PanoramaIsItsColours) {
  write_exr(temporary("panorama.exr"), some_layers());
  const RadianceImage image = read_radiance(temporary("panorama.exr"));
  EXPECT_EQ(image.pixels[3], Vec3f::Constant(2.0f));
}

template <typename Read>
std::string error_of(const Read& read) {
  try {
    read();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Exr, RefusesWhatItCannotRead) {
  std::ofstream(temporary("noise.exr")) << "this is no picture at all";
  EXPECT_NE(error_of([] { read_exr(temporary("noise.exr")); }).find("noise.exr"), std::string::npos);
  EXPECT_NE(error_of([] { read_exr(temporary("none.exr")); }).find("no such file"), std::string::npos);
  write_exr(temporary("whole.exr"), some_layers());
  const std::string bytes = read_file(temporary("whole.exr"));
  write_file_atomically(temporary("cut.exr"), bytes.substr(0, bytes.size() / 2));
  EXPECT_NE(error_of([] { read_exr(temporary("cut.exr")); }).find("cut.exr"), std::string::npos);
  LayeredImage dark = some_layers();
  dark.channels[0].values[1] = -1.0f;
  write_exr(temporary("dark.exr"), dark);
  EXPECT_NE(error_of([] { read_radiance(temporary("dark.exr")); }).find("not negative"), std::string::npos);
  LayeredImage grey = some_layers();
  grey.channels.erase(grey.channels.begin());
  write_exr(temporary("grey.exr"), grey);
  EXPECT_NE(error_of([] { read_radiance(temporary("grey.exr")); }).find("no channel R"), std::string::npos);
}

std::string hdr_heading(int width, int height) {
  return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " + std::to_string(width) + "\n";
}

TEST(RadianceHdr, ReadsFlatPixels) {
  write_file_atomically(temporary("flat.hdr"), hdr_heading(2, 1) + std::string("\x80\x40\x20\x81\x00\x00\x00\x00", 8));
  const RadianceImage image = read_radiance(temporary("flat.hdr"));
  // (128 + 1/2) 2^(129 - 136)
  EXPECT_FLOAT_EQ(image.pixels[0].x(), 128.5f / 128.0f);
  EXPECT_FLOAT_EQ(image.pixels[0].z(), 32.5f / 128.0f);
  EXPECT_TRUE(image.pixels[1].isZero(0.0f));
}

TEST(RadianceHdr, ReadsRunsOfComponents) {
  // Eight pixels: red a run of 8, green a run of 4 and four different, blue and exponent runs.
  std::string row("\x02\x02\x00\x08", 4);
  row += std::string("\x88\x10", 2) + std::string("\x84\x20\x04\x01\x02\x03\x04", 7) + std::string("\x88\x30", 2) +
         std::string("\x88\x80", 2);
  write_file_atomically(temporary("runs.hdr"), hdr_heading(8, 1) + row);
  const RadianceImage image = read_radiance(temporary("runs.hdr"));
  EXPECT_FLOAT_EQ(image.pixels[7].x(), 16.5f / 256.0f);
  EXPECT_FLOAT_EQ(image.pixels[3].y(), 32.5f / 256.0f);
  EXPECT_FLOAT_EQ(image.pixels[6].y(), 3.5f / 256.0f);
}

TEST(RadianceHdr, RefusesWhatIsDamaged) {
  write_file_atomically(temporary("cut.hdr"), hdr_heading(4, 4) + std::string(20, 'x'));
  EXPECT_NE(error_of([] { read_radiance(temporary("cut.hdr")); }).find("damaged"), std::string::npos);
  write_file_atomically(temporary("no.hdr"), "P6 3 3 255\n");
  EXPECT_NE(error_of([] { read_radiance(temporary("no.hdr")); }).find("#?RADIANCE"), std::string::npos);
  write_file_atomically(temporary("long.hdr"), hdr_heading(8, 1) + std::string("\x02\x02\x00\x08\xff\x10", 6));
  EXPECT_NE(error_of([] { read_radiance(temporary("long.hdr")); }).find("past the end"), std::string::npos);
  write_file_atomically(temporary("xyze.hdr"), "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n");
  EXPECT_NE(error_of([] { read_radiance(temporary("xyze.hdr")); }).find("xyze"), std::string::npos);
}

TEST(Png, SixteenBitsComeBackInTheirUpperEight) {
  const ImageRgb16 image{2, 1, {{0x1234, 0xffff, 0}, {0x8080, 1, 0x0101}}};
  write_png(temporary("deep.png"), image);
  const std::string bytes = read_file(temporary("deep.png"));
  EXPECT_EQ(bytes[24], 16);  // bit depth, in the header
  const ImageRgb8 back = read_png(temporary("deep.png"));
  EXPECT_EQ(back.pixels[0], (std::array<std::uint8_t, 3>{0x12, 0xff, 0}));
}

}  // namespace
}  // namespace smelt
