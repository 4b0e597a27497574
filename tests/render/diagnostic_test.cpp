#include "render/diagnostic.h"

#include "tests/render/test_meshes.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace smelt {
namespace {

struct Setting {
  RenderScene scene = test::white_room(120, 90);
  std::vector<Vec3> position{Vec3(-0.6, 0.0, 0.0), Vec3(0.6, 0.0, 0.0)};
  std::vector<float> value{0.0f, 10.0f};

  DiagnosticPicture picture() const {
    return {position, value, 0.5, {"speed [m/s]", 0.0, 10.0, false}, "test", nullptr, SurfaceOverlay::none};
  }
};

std::array<std::uint8_t, 3> pixel(const ImageRgb8& image, int x, int y) {
  return image.pixels[static_cast<std::size_t>(y * image.width + x)];
}

TEST(Diagnostic, ParticlesHaveTheColoursOfTheirValues) {
  const Setting s;
  const ImageRgb8 image = draw_diagnostic(s.picture(), s.scene);
  // White room: 30 degrees over 90 pixels from 5 m away; spheres of half a metre at +-0.6 m.
  const auto low = pixel(image, 60 - 20, 45), high = pixel(image, 60 + 20, 45);
  EXPECT_GT(low[2], low[1]);  // violet
  EXPECT_GT(high[0], 150);    // yellow
  EXPECT_GT(high[1], high[2] + 50);
  EXPECT_GT(pixel(image, 60, 80)[1], 240);  // paper
}

TEST(Diagnostic, OverlaysShowTheSurface) {
  const Setting s;
  DiagnosticPicture picture = s.picture();
  const SurfaceMesh ball = test::make_sphere(1.3, Vec3::Zero(), 8);
  const ImageRgb8 bare = draw_diagnostic(picture, s.scene);
  picture.surface = &ball;
  picture.overlay = SurfaceOverlay::wire;
  const ImageRgb8 wire = draw_diagnostic(picture, s.scene);
  picture.overlay = SurfaceOverlay::translucent;
  const ImageRgb8 skin = draw_diagnostic(picture, s.scene);
  const auto n_changed = [&](const ImageRgb8& image) {
    int n = 0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) n += image.pixels[i] != bare.pixels[i] ? 1 : 0;
    return n;
  };
  EXPECT_GT(n_changed(wire), 300);
  EXPECT_GT(n_changed(skin), 2 * n_changed(wire) / 3);
  EXPECT_LT(n_changed(wire), 120 * 90 / 2);
}

TEST(Diagnostic, SameBytesOnAnyThreadCount) {
  const Setting s;
  const auto draw = [&](std::size_t n) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, n);
    return draw_diagnostic(s.picture(), s.scene).pixels;
  };
  EXPECT_EQ(draw(1), draw(2));
}

}  // namespace
}  // namespace smelt
