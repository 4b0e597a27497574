#include "io/png.h"

#include "core/error.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace smelt {
namespace {

class PngTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("smelt_png_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

ImageRgb8 make_image(int width, int height) {
  ImageRgb8 image{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.pixels.push_back(
          {static_cast<std::uint8_t>(7 * x), static_cast<std::uint8_t>(11 * y), static_cast<std::uint8_t>(x * y)});
    }
  }
  return image;
}

TEST_F(PngTest, ReadsBackWhatWasWritten) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{37, 23}, std::pair{1280, 3}}) {
    const ImageRgb8 image = make_image(width, height);
    write_png(folder_ / "a.png", image);
    const ImageRgb8 back = read_png(folder_ / "a.png");
    EXPECT_EQ(back.width, width);
    EXPECT_EQ(back.height, height);
    EXPECT_EQ(back.pixels, image.pixels);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.png.tmp"));
}

TEST_F(PngTest, RefusesImagesThatDoNotFit) {
  EXPECT_THROW(write_png(folder_ / "a.png", ImageRgb8{}), Error);
  ImageRgb8 image = make_image(4, 4);
  image.pixels.pop_back();
  EXPECT_THROW(write_png(folder_ / "a.png", image), Error);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.png"));
}

TEST_F(PngTest, RefusesMissingAndDamagedFiles) {
  EXPECT_THROW(read_png(folder_ / "none.png"), Error);
  std::ofstream(folder_ / "text.png") << "no picture";
  EXPECT_THROW(read_png(folder_ / "text.png"), Error);
  write_png(folder_ / "cut.png", make_image(64, 64));
  std::filesystem::resize_file(folder_ / "cut.png", std::filesystem::file_size(folder_ / "cut.png") / 2);
  EXPECT_THROW(read_png(folder_ / "cut.png"), Error);
}

TEST_F(PngTest, NoFolderNoFile) {
  EXPECT_THROW(write_png(folder_ / "missing" / "a.png", make_image(2, 2)), Error);
}

}  // namespace
}  // namespace smelt
