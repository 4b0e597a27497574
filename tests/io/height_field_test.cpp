#include "io/height_field.h"

#include "core/error.h"
#include "tests/source_folder.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace smelt {
namespace {

class HeightFieldFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("smelt_height_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  /// The error's text, without the folder.
  std::string error_of(const std::string& name, const std::string& text, const HeightScale& scale = {}) {
    try {
      read_height_field(write(name, text), scale);
    } catch (const Error& error) {
      const std::string what = error.what();
      return what.substr(what.find(name));
    }
    return "none";
  }
  /// A grey picture of 16 bits: 256 * row + column in each pixel.
  std::string make_png(int columns, int rows, int depth = 16, int colour = PNG_COLOR_TYPE_GRAY) {
    const std::filesystem::path path = folder_ / "made.png";
    FILE* file = std::fopen(path.c_str(), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, static_cast<png_uint_32>(columns), static_cast<png_uint_32>(rows), depth, colour,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_gAMA(png, info, 0.45455);  // to be left aside: heights are no light
    png_write_info(png, info);
    for (int r = 0; r < rows; ++r) {
      std::vector<png_byte> row;
      for (int c = 0; c < columns; ++c)
        for (int byte = 0; byte < (depth / 8) * (colour == PNG_COLOR_TYPE_RGB ? 3 : 1); ++byte)
          row.push_back(static_cast<png_byte>(depth == 16 && byte % 2 == 0 ? r : c));
      png_write_row(png, row.data());
    }
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    std::fclose(file);
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  std::filesystem::path folder_;
};

const std::string grid =
    "NCOLS 3\nnrows 2\nxllcorner 500000\nyllcorner 4e6\ncellsize 2.5\nNODATA_value -9999\n1 2 3\n4 5.5 -6e0\n";

TEST_F(HeightFieldFile, EsriGrid) {
  const HeightField f = read_height_field(write("a.asc", grid), {});
  EXPECT_EQ(f.n_columns, 3u);
  EXPECT_EQ(f.n_rows, 2u);
  EXPECT_EQ(f.cell, 2.5);
  EXPECT_EQ(f.height, (std::vector<double>{1, 2, 3, 4, 5.5, -6}));
  const HeightField scaled = read_height_field(write("a.asc", grid), {5.0, 0.5, 0.0, 1.0});
  EXPECT_EQ(scaled.cell, 5.0);
  EXPECT_EQ(scaled.height[4], 2.75);
}

TEST_F(HeightFieldFile, NanMayMarkMissingHeights) {
  const std::string head = "ncols 2\nnrows 2\ncellsize 1\n";
  EXPECT_EQ(read_height_field(write("nan.asc", head + "NODATA_value nan\n1 2\n3 4\n"), {}).height.size(), 4u);
  EXPECT_EQ(error_of("nan.asc", head + "NODATA_value nan\n1 2\n3 nan\n"),
            "nan.asc:6: row 2, column 2: NODATA (nan); a terrain has no holes, fill the gap in the data");
  EXPECT_EQ(error_of("nan.asc", "ncols 2\nnrows 2\ncellsize nan\n1 2\n3 4\n"),
            "nan.asc:3: cellsize must be a finite number of metres, is nan");
}

TEST_F(HeightFieldFile, UpperCaseExtensionsSignsAndByteOrderMarks) {
  EXPECT_TRUE(is_height_field("A.ASC") && is_height_field("a.Csv") && is_height_field("a.PNG"));
  EXPECT_EQ(read_height_field(write("A.ASC", "\xef\xbb\xbf" + grid), {}).cell, 2.5);
  EXPECT_EQ(read_height_field(write("A.CSV", "\xef\xbb\xbf+1,2\n3,-4\n"), {1.0, 1.0, 0.0, 1.0}).height,
            (std::vector<double>{1, 2, 3, -4}));
  EXPECT_EQ(error_of("a.csv", "+-1,2\n3,4\n", {1.0, 1.0, 0.0, 1.0}),
            "a.csv:1: row 1, column 1: expected a number, found \"+-1\"");
}

TEST_F(HeightFieldFile, CsvWithAnySeparator) {
  const HeightField f =
      read_height_field(write("a.csv", "# heights\n1,2,3\r\n4; 5; 6\n\n7\t8 9"), {10.0, 2.0, 0.0, 1.0});
  EXPECT_EQ(f.n_columns, 3u);
  EXPECT_EQ(f.n_rows, 3u);
  EXPECT_EQ(f.height, (std::vector<double>{2, 4, 6, 8, 10, 12, 14, 16, 18}));
}

TEST_F(HeightFieldFile, PngOf16And8Bits) {
  const HeightField f = read_height_field(write("a.png", make_png(5, 3)), {1.0, 1.0, 100.0, 100.0 + 65535.0});
  ASSERT_EQ(f.n_columns, 5u);
  ASSERT_EQ(f.n_rows, 3u);
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 5; ++c)
      ASSERT_DOUBLE_EQ(f.at(c, r), 100.0 + 256.0 * static_cast<double>(r) + static_cast<double>(c));
  const HeightField eight = read_height_field(write("b.png", make_png(5, 3, 8)), {1.0, 1.0, 0.0, 255.0});
  EXPECT_DOUBLE_EQ(eight.at(4, 2), 4.0);
}

TEST_F(HeightFieldFile, SaysWhereAndWhatIsWrong) {
  const std::string head = "ncols 3\nnrows 2\ncellsize 1\nNODATA_value -9999\n";
  EXPECT_EQ(error_of("a.asc", head + "1 2 3\n4 -9999 6\n"),
            "a.asc:6: row 2, column 2: NODATA (-9999); a terrain has no holes, fill the gap in the data");
  EXPECT_EQ(error_of("a.asc", head + "1 2 3\n4 nan 6\n"),
            "a.asc:6: row 2, column 2: the height is nan; a terrain's must be finite, fill the gap in the data");
  EXPECT_EQ(error_of("a.asc", head + "1 2 3\n4 5\n"), "a.asc:6: row 2 has only 2 heights; ncols says 3");
  EXPECT_EQ(error_of("a.asc", head + "1 2 3 4\n4 5 6\n"), "a.asc:5: row 1 has more than 3 heights; ncols says 3");
  EXPECT_EQ(error_of("a.asc", head + "1 2 3\n"), "a.asc:5: the file ends after 1 rows of heights; nrows says 2");
  EXPECT_EQ(error_of("a.asc", head + "1 2 3\n4 5 6\n7 8 9\n"),
            "a.asc:6: there is more after the last of the 2 rows that nrows gives");
  EXPECT_EQ(error_of("a.asc", head + "1 2 x3\n4 5 6\n"), "a.asc:5: row 1, column 3: expected a number, found \"x3\"");
  EXPECT_EQ(error_of("a.asc", "nrows 2\n1 2\n"), "a.asc: the header lacks ncols; is it an ESRI ASCII grid?");
  EXPECT_EQ(error_of("a.asc", "ncols 3\nnrows 2\n1 2 3\n4 5 6\n"),
            "a.asc: the header lacks cellsize; give [collider.terrain] cell_m");
  EXPECT_NE(error_of("a.asc", "ncols 3\nrows 2\n").find("\"rows\" is no key"), std::string::npos);
  EXPECT_EQ(error_of("a.asc", "ncols 1e9\nnrows 2\ncellsize 1\n1\n"),
            "a.asc: ncols must be a whole number from 1 to 100000, is 1000000000");
  EXPECT_NE(error_of("a.asc", "").find("lacks ncols"), std::string::npos);
  EXPECT_EQ(error_of("a.csv", "1,2\n3\n", {1.0, 1.0, 0.0, 1.0}), "a.csv:2: row 2 has 1 heights, the first row 2");
  EXPECT_EQ(error_of("a.csv", "1,2\n3,inf\n", {1.0, 1.0, 0.0, 1.0}),
            "a.csv:2: row 2, column 2: the height is inf; a terrain's must be finite, fill the gap in the data");
  EXPECT_NE(error_of("a.csv", "1,2\n3,4\n").find("give [collider.terrain] cell_m"), std::string::npos);
  EXPECT_EQ(error_of("a.csv", "1,2\n", {1.0, 1.0, 0.0, 1.0}),
            "a.csv: a terrain needs at least 2 x 2 heights, this file has 2 x 1");
}

TEST_F(HeightFieldFile, RefusesDamagedAndColouredPictures) {
  const std::string png = make_png(40, 30);
  const HeightScale scale{1.0, 1.0, 0.0, 1.0};
  for (const std::size_t n : {std::size_t{0}, std::size_t{5}, std::size_t{40}, png.size() / 2, png.size() - 13})
    EXPECT_NE(error_of("a.png", png.substr(0, n), scale).find("cannot be read as a PNG"), std::string::npos)
        << n << " bytes";
  EXPECT_NE(error_of("a.png", make_png(4, 4, 8, PNG_COLOR_TYPE_RGB), scale).find("grey"), std::string::npos);
}

TEST_F(HeightFieldFile, MaungaWhauIsAsItsSourceSays) {
  const HeightField f = read_height_field(source_folder() / "assets/maunga_whau.asc", {});
  EXPECT_EQ(f.n_columns, 87u);
  EXPECT_EQ(f.n_rows, 61u);
  EXPECT_EQ(f.cell, 10.0);
  EXPECT_EQ(*std::min_element(f.height.begin(), f.height.end()), 94.0);
  EXPECT_EQ(*std::max_element(f.height.begin(), f.height.end()), 195.0);
}

}  // namespace
}  // namespace smelt
