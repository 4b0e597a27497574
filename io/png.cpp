#include "io/png.h"

#include "core/error.h"
#include "io/atomic_file.h"

#include <png.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

namespace smelt {

namespace {

constexpr int n_channels = 3;

/// Encodes with libpng's full interface: its simple one takes 16-bit pixels for linear light.
class PngEncoder {
 public:
  explicit PngEncoder(const std::filesystem::path& path) : path_(path) {
    png_ = png_create_write_struct(PNG_LIBPNG_VER_STRING, this, refuse, [](png_structp, png_const_charp) {});
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ == nullptr) fail("{}: out of memory while encoding the image", path.string());
  }
  ~PngEncoder() { png_destroy_write_struct(&png_, &info_); }
  PngEncoder(const PngEncoder&) = delete;
  PngEncoder& operator=(const PngEncoder&) = delete;

  template <typename Channel>
  std::string encode(const ImageRgb<Channel>& image) {
    constexpr int bits = 8 * static_cast<int>(sizeof(Channel));
    png_set_write_fn(png_, &bytes_, append, [](png_structp) {});
    png_set_IHDR(png_, info_, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), bits,
                 PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png_, info_, PNG_sRGB_INTENT_PERCEPTUAL);
    // Frames are written once and read by people: speed before the last few per cent of size.
    png_set_compression_level(png_, 1);
    png_set_filter(png_, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_write_info(png_, info_);
    if constexpr (bits == 16) png_set_swap(png_);
    for (int y = 0; y < image.height; ++y)
      png_write_row(png_, reinterpret_cast<png_const_bytep>(
                              &image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width)]));
    png_write_end(png_, nullptr);
    return std::move(bytes_);
  }

 private:
  [[noreturn]] static void refuse(png_structp png, png_const_charp message) {
    fail("{}: cannot encode the image: {}", static_cast<PngEncoder*>(png_get_error_ptr(png))->path_.string(), message);
  }
  static void append(png_structp png, png_bytep data, png_size_t n) {
    static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), n);
  }

  const std::filesystem::path& path_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::string bytes_;
};

template <typename Channel>
void write_rgb(const std::filesystem::path& path, const ImageRgb<Channel>& image) {
  const std::size_t n = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.width < 1 || image.height < 1 || image.pixels.size() != n)
    fail("{}: an image of {} x {} with {} pixels cannot be written", path.string(), image.width, image.height,
         image.pixels.size());
  static_assert(sizeof(image.pixels[0]) == n_channels * sizeof(Channel));
  write_file_atomically(path, PngEncoder(path).encode(image));
}

}  // namespace

void write_png(const std::filesystem::path& path, const ImageRgb8& image) {
  write_rgb(path, image);
}

void write_png(const std::filesystem::path& path, const ImageRgb16& image) {
  write_rgb(path, image);
}

ImageRgb8 read_png(const std::filesystem::path& path) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&header, path.c_str()) == 0) {
    fail("{}: cannot be read as a PNG: {}", path.string(), header.message);
  }
  header.format = PNG_FORMAT_RGB;
  ImageRgb8 image;
  image.width = static_cast<int>(header.width);
  image.height = static_cast<int>(header.height);
  image.pixels.resize(static_cast<std::size_t>(header.width) * header.height);
  const png_color black{0, 0, 0};
  if (png_image_finish_read(&header, &black, image.pixels.data(), 0, nullptr) == 0) {
    fail("{}: damaged PNG: {}", path.string(), header.message);
  }
  return image;
}

}  // namespace smelt
