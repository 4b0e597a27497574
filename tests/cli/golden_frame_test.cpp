// The first frame of scenes, small, beside pictures that somebody has looked at.
//
// Metric: the root mean square over pixels of the distance in Oklab between shown and golden colour (delta E_OK), times 100; 2 is the
// least difference that is seen side by side. SMELT_UPDATE_GOLDEN=1 writes the pictures of tests/data/golden anew: look at them.

#include "io/png.h"
#include "render/colour_map.h"
#include "render/tone_map.h"
#include "tests/source_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

namespace smelt {
namespace {

namespace fs = std::filesystem;

Vec3 oklab_of(const std::array<std::uint8_t, 3>& pixel) {
  Vec3 linear;
  for (std::size_t c = 0; c < 3; ++c) linear[static_cast<int>(c)] = linear_from_srgb(static_cast<float>(pixel[c]) / 255.0f);
  return oklab_from_rgb(linear);
}

struct Difference {
  double metric = 0.0;
  ImageRgb8 image;  ///< distance of each pixel, 10 delta E_OK being white
};

Difference compare(const ImageRgb8& shown, const ImageRgb8& golden) {
  Difference d{0.0, {shown.width, shown.height, {}}};
  double sum = 0.0;
  for (std::size_t i = 0; i < shown.pixels.size(); ++i) {
    const double distance = 100.0 * (oklab_of(shown.pixels[i]) - oklab_of(golden.pixels[i])).norm();
    sum += distance * distance;
    const auto grey = static_cast<std::uint8_t>(std::min(255.0, 25.5 * distance));
    d.image.pixels.push_back({grey, grey, grey});
  }
  d.metric = std::sqrt(sum / static_cast<double>(shown.pixels.size()));
  return d;
}

class GoldenFrame : public testing::TestWithParam<const char*> {};

TEST_P(GoldenFrame, LooksAsItDid) {
  const std::string name = GetParam();
  const fs::path folder = fs::path(testing::TempDir()) / ("smelt_golden_" + name), golden = source_folder() / "tests/data/golden" / (name + ".png");
  fs::remove_all(folder);
  const std::string command = fmt::format("'{}' run '{}' -o '{}' --frames 1 --set camera.width=192 --set camera.height=108 --set render.samples=8 > '{}' 2>&1",
                                          SMELT_PROGRAM, (source_folder() / "scenes" / (name + ".toml")).string(), folder.string(),
                                          (folder.string() + ".log"));
  ASSERT_EQ(std::system(command.c_str()), 0) << folder << ".log";
  const ImageRgb8 shown = read_png(folder / "frames/frame.0001.png");
  if (std::getenv("SMELT_UPDATE_GOLDEN") != nullptr) {
    write_png(golden, shown);
    GTEST_SKIP() << "wrote " << golden;
  }
  const ImageRgb8 expected = read_png(golden);
  ASSERT_EQ(shown.width, expected.width);
  ASSERT_EQ(shown.height, expected.height);
  const Difference difference = compare(shown, expected);
  const fs::path kept = fs::path(testing::TempDir()) / ("smelt_golden_" + name + ".difference.png");
  write_png(kept, difference.image);
  EXPECT_LT(difference.metric, 1.0) << "the difference is in " << kept << ", the picture in " << folder;
}

INSTANTIATE_TEST_SUITE_P(Scenes, GoldenFrame, testing::Values("melting_bunny", "chair_hand"),
                         [](const auto& test) { return std::string(test.param); });

TEST(GoldenMetric, SeesAShiftAndOnlyThat) {
  ImageRgb8 a{4, 1, {{10, 20, 30}, {90, 90, 90}, {200, 10, 10}, {255, 255, 255}}}, b = a;
  EXPECT_EQ(compare(a, b).metric, 0.0);
  for (auto& pixel : b.pixels) pixel[0] = static_cast<std::uint8_t>(pixel[0] > 40 ? pixel[0] - 40 : pixel[0] + 40);
  EXPECT_GT(compare(a, b).metric, 2.0);
}

}  // namespace
}  // namespace smelt
