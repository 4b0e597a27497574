// A frame of every scene, small, beside pictures that somebody has looked at.
//
// Metric: the root mean square over pixels of the distance in Oklab between shown and golden colour (delta E_OK), times
// 100; 2 is the least difference that is seen side by side. SMELT_UPDATE_GOLDEN=1 writes the pictures of
// tests/data/golden anew: look at them.

#include "io/png.h"
#include "render/colour_map.h"
#include "render/tone_map.h"
#include "tests/source_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <ostream>
#include <string>

namespace smelt {
namespace {

namespace fs = std::filesystem;

Vec3 oklab_of(const std::array<std::uint8_t, 3>& pixel) {
  Vec3 linear;
  for (std::size_t c = 0; c < 3; ++c)
    linear[static_cast<int>(c)] = linear_from_srgb(static_cast<float>(pixel[c]) / 255.0f);
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

/// A frame of a scene; what pours shows something only later, and coarser, but before drops roll apart: then every
/// rounding shows.
struct Shot {
  std::string scene;
  int frame = 1;
  std::string settings = {};

  std::string name() const {
    std::string name = scene;
    std::replace(name.begin(), name.end(), '/', '_');
    return name;
  }
};

void PrintTo(const Shot& shot, std::ostream* out) {
  *out << shot.scene;
}

class GoldenFrame : public testing::TestWithParam<Shot> {};

TEST_P(GoldenFrame, LooksAsItDid) {
  const Shot& shot = GetParam();
  const std::string name = shot.name();
  const fs::path folder = fs::path(testing::TempDir()) / ("smelt_golden_" + name),
                 golden = source_folder() / "tests/data/golden" / (name + ".png");
  fs::remove_all(folder);
  const auto run = [&](const std::string& verb, int first) {
    const std::string command = fmt::format(
        "'{}' {} '{}' -o '{}' --frames {}-{} --set camera.width=192 --set camera.height=108 --set render.samples=8 {} "
        "> '{}' 2>&1",
        SMELT_PROGRAM, verb, (source_folder() / "scenes" / (shot.scene + ".toml")).string(), folder.string(), first,
        shot.frame, shot.settings, folder.string() + ".log");
    ASSERT_EQ(std::system(command.c_str()), 0) << folder << ".log";
  };
  run("simulate", 1);
  run("surface", shot.frame);
  run("render", shot.frame);
  const ImageRgb8 shown = read_png(folder / "frames" / fmt::format("frame.{:04}.png", shot.frame));
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

// The rest of scenes/thesis are links to these.
INSTANTIATE_TEST_SUITE_P(Scenes, GoldenFrame,
                         testing::Values(Shot{"melting_bunny"}, Shot{"chair_hand"}, Shot{"candle"},
                                         Shot{"lava_volcano", 28, "--set particles.spacing_m=6"},
                                         Shot{"lava_sugarloaf", 40, "--set particles.spacing_m=8"}, Shot{"thesis/wall"},
                                         Shot{"thesis/hand"}, Shot{"thesis/candle"}, Shot{"thesis/gargoyle"},
                                         Shot{"thesis/letters", 1, "--set camera.height=77"},
                                         Shot{"thesis/terrain", 28, "--set particles.spacing_m=6"}),
                         [](const auto& test) { return test.param.name(); });

TEST(GoldenMetric, SeesAShiftAndOnlyThat) {
  ImageRgb8 a{4, 1, {{10, 20, 30}, {90, 90, 90}, {200, 10, 10}, {255, 255, 255}}}, b = a;
  EXPECT_EQ(compare(a, b).metric, 0.0);
  for (auto& pixel : b.pixels) pixel[0] = static_cast<std::uint8_t>(pixel[0] > 40 ? pixel[0] - 40 : pixel[0] + 40);
  EXPECT_GT(compare(a, b).metric, 2.0);
}

}  // namespace
}  // namespace smelt
