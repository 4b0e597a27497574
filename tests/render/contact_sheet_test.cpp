#include "render/contact_sheet.h"

#include "core/error.h"
#include "render/lettering.h"

#include <gtest/gtest.h>

namespace smelt {
namespace {

ImageRgb8 plain(int width, int height, std::uint8_t grey) {
  return {width, height,
          std::vector<std::array<std::uint8_t, 3>>(static_cast<std::size_t>(width * height), {grey, grey, grey})};
}

TEST(ContactSheet, PicturesStandInRowsAndKeepTheirLight) {
  const ImageRgb8 sheet = make_contact_sheet({plain(300, 200, 10), plain(300, 200, 90), plain(300, 200, 200)}, 2, 320);
  EXPECT_LE(sheet.width, 320);
  const auto at = [&](int x, int y) { return sheet.pixels[static_cast<std::size_t>(y * sheet.width + x)][0]; };
  EXPECT_EQ(at(sheet.width / 4, sheet.height / 4), 10);
  EXPECT_EQ(at(3 * sheet.width / 4, sheet.height / 4), 90);
  EXPECT_EQ(at(sheet.width / 4, 3 * sheet.height / 4), 200);
  EXPECT_EQ(at(3 * sheet.width / 4, 3 * sheet.height / 4), 255);
}

TEST(ContactSheet, RefusesPicturesOfTwoSizes) {
  EXPECT_THROW(make_contact_sheet({plain(30, 20, 1), plain(31, 20, 1)}, 2), Error);
}

TEST(Lettering, IsAsWideAsItSaysAndStaysInThePicture) {
  ImageRgb8 image = plain(40, 12, 255);
  draw_text(image, 2, 2, "1k", 1, {0, 0, 0});
  int rightmost = 0;
  for (int i = 0; i < 40 * 12; ++i)
    if (image.pixels[static_cast<std::size_t>(i)][0] == 0) rightmost = std::max(rightmost, i % 40);
  EXPECT_GT(rightmost, 8);
  EXPECT_LT(rightmost, 2 + text_width("1k", 1));
  EXPECT_NO_THROW(draw_text(image, -10, 8, "far out \xc3\xa4", 5, {0, 0, 0}));
}

}  // namespace
}  // namespace smelt
