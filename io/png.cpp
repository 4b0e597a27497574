#include "io/png.h"

#include "core/error.h"
#include "io/atomic_file.h"

#include <png.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

namespace smelt {

void write_png(const std::filesystem::path& path, const ImageRgb8& image) {
  const std::size_t n = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.width < 1 || image.height < 1 || image.pixels.size() != n) {
    fail("{}: an image of {} x {} with {} pixels cannot be written", path.string(), image.width, image.height,
         image.pixels.size());
  }
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  // Frames are written once and read by people: speed before the last few per cent of size.
  header.flags = PNG_IMAGE_FLAG_FAST;
  png_alloc_size_t n_bytes = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string bytes(n_bytes, '\0');
  if (png_image_write_to_memory(&header, bytes.data(), &n_bytes, 0, image.pixels.data(), 0, nullptr) == 0) {
    fail("{}: cannot encode the image: {}", path.string(), header.message);
  }
  bytes.resize(n_bytes);
  write_file_atomically(path, bytes);
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
