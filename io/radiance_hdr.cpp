#include "io/radiance_hdr.h"

#include "core/error.h"
#include "io/atomic_file.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace smelt {

namespace {

using Rgbe = std::array<std::uint8_t, 4>;

/// The bytes of a file, from front to back.
class Bytes {
 public:
  Bytes(const std::filesystem::path& path, std::string content) : path_(path), content_(std::move(content)) {}

  std::uint8_t next() {
    if (at_ >= content_.size()) fail("{}: ends in the middle of the picture; the file is damaged", path_.string());
    return static_cast<std::uint8_t>(content_[at_++]);
  }
  Rgbe next_pixel() { return {next(), next(), next(), next()}; }
  std::string next_line() {
    std::string line;
    for (char c = static_cast<char>(next()); c != '\n'; c = static_cast<char>(next())) line += c;
    return line;
  }
  void back(std::size_t n) { at_ -= n; }

 private:
  const std::filesystem::path& path_;
  std::string content_;
  std::size_t at_ = 0;
};

/// A row whose four components follow each other, each in runs and stretches.
void read_component_runs(Bytes& bytes, std::vector<Rgbe>& row, const std::filesystem::path& path) {
  for (std::size_t component = 0; component < 4; ++component)
    for (std::size_t x = 0; x < row.size();) {
      const std::size_t count = bytes.next();
      const bool run = count > 128;
      const std::size_t n = run ? count - 128 : count;
      if (n == 0 || x + n > row.size())
        fail("{}: a run goes past the end of its row; the file is damaged", path.string());
      const std::uint8_t repeated = run ? bytes.next() : std::uint8_t{0};
      for (std::size_t k = 0; k < n; ++k) row[x++][component] = run ? repeated : bytes.next();
    }
}

/// A row of whole pixels; (1, 1, 1, n) repeats the one before n times, and again for the next higher byte of n.
void read_pixels(Bytes& bytes, std::vector<Rgbe>& row, const std::filesystem::path& path) {
  int shift = 0;
  for (std::size_t x = 0; x < row.size();) {
    const Rgbe pixel = bytes.next_pixel();
    if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
      const std::size_t n = static_cast<std::size_t>(pixel[3]) << shift;
      if (x == 0 || shift > 16 || x + n > row.size())
        fail("{}: a run goes past the end of its row; the file is damaged", path.string());
      for (std::size_t k = 0; k < n; ++k, ++x) row[x] = row[x - 1];
      shift += 8;
    } else {
      row[x++] = pixel;
      shift = 0;
    }
  }
}

Vec3f to_radiance(const Rgbe& p) {
  if (p[3] == 0) return Vec3f::Zero();
  const float scale = std::ldexp(1.0f, static_cast<int>(p[3]) - 136);
  return {(static_cast<float>(p[0]) + 0.5f) * scale, (static_cast<float>(p[1]) + 0.5f) * scale,
          (static_cast<float>(p[2]) + 0.5f) * scale};
}

}  // namespace

RadianceImage read_radiance_hdr(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path)) fail("{}: there is no such file", path.string());
  Bytes bytes(path, read_file(path));
  // Heading, then an empty line, then the size.
  const std::string magic = bytes.next_line();
  if (!magic.starts_with("#?")) fail("{}: is no Radiance picture: it does not begin with #?RADIANCE", path.string());
  for (std::string line = bytes.next_line(); !line.empty(); line = bytes.next_line())
    if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
      fail("{}: has {}; only 32-bit_rle_rgbe is read", path.string(), line);
  RadianceImage image;
  const std::string size = bytes.next_line();
  if (std::sscanf(size.c_str(), "-Y %d +X %d", &image.height, &image.width) != 2 || image.width < 1 ||
      image.height < 1 || image.width > 65535 || image.height > 65535)
    fail("{}: has size \"{}\"; -Y height +X width is read, up to 65535", path.string(), size);
  std::vector<Rgbe> row(static_cast<std::size_t>(image.width));
  for (int y = 0; y < image.height; ++y) {
    const Rgbe first = bytes.next_pixel();
    const bool runs = first[0] == 2 && first[1] == 2 && first[2] < 128 && (first[2] << 8 | first[3]) == image.width;
    if (runs) {
      read_component_runs(bytes, row, path);
    } else {
      bytes.back(4);
      read_pixels(bytes, row, path);
    }
    for (const Rgbe& pixel : row) image.pixels.push_back(to_radiance(pixel));
  }
  return image;
}

}  // namespace smelt
