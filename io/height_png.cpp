#include "core/error.h"
#include "io/atomic_file.h"
#include "io/height_field.h"

#include <png.h>

#include <csetjmp>
#include <cstring>

namespace smelt {

namespace {

/// What libpng reads from and reports to.
struct Source {
  const char* bytes = nullptr;
  std::size_t left = 0;
  char message[200] = {};
};

void take_bytes(png_structp png, png_bytep out, std::size_t n) {
  auto* source = static_cast<Source*>(png_get_io_ptr(png));
  if (n > source->left) png_error(png, "the file ends too soon");
  std::memcpy(out, source->bytes, n);
  source->bytes += n;
  source->left -= n;
}

[[noreturn]] void keep_message(png_structp png, png_const_charp text) {
  auto* source = static_cast<Source*>(png_get_error_ptr(png));
  std::strncpy(source->message, text, sizeof(source->message) - 1);
  png_longjmp(png, 1);
}

void ignore_warning(png_structp, png_const_charp) {}

/// Decodes into libpng's own rows. Nothing here has a destructor: libpng leaves by longjmp. Returns whether it went
/// well.
bool decode(png_structp png, png_infop info, Source* source) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_read_fn(png, source, take_bytes);
  png_read_png(png, info, PNG_TRANSFORM_EXPAND | PNG_TRANSFORM_STRIP_ALPHA, nullptr);
  return true;
}

}  // namespace

HeightField read_height_png(const std::filesystem::path& path, const HeightScale& scale) {
  if (!scale.cell)
    fail("{}: a picture does not say how far apart its heights are; give [collider.terrain] cell_m", path.string());
  const std::string bytes = read_file(path);
  Source source{bytes.data(), bytes.size(), {}};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, keep_message, ignore_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info) fail("{}: libpng cannot start", path.string());
  const bool sound = decode(png, info, &source);
  const png_byte colour = sound ? png_get_color_type(png, info) : PNG_COLOR_TYPE_GRAY;
  const std::size_t depth = sound ? png_get_bit_depth(png, info) / 8U : 1;

  HeightField field;
  field.cell = *scale.cell;
  if (sound && colour == PNG_COLOR_TYPE_GRAY) {
    field.n_columns = png_get_image_width(png, info);
    field.n_rows = png_get_image_height(png, info);
    png_bytepp rows = png_get_rows(png, info);
    const double white = depth == 2 ? 65535.0 : 255.0;
    for (std::size_t r = 0; r < field.n_rows; ++r)
      for (std::size_t c = 0; c < field.n_columns; ++c) {
        const png_byte* pixel = rows[r] + depth * c;
        const double value = depth == 2 ? 256.0 * pixel[0] + pixel[1] : pixel[0];
        field.height.push_back(scale.lowest + (scale.highest - scale.lowest) * value / white);
      }
  }
  png_destroy_read_struct(&png, &info, nullptr);
  if (!sound) fail("{}: cannot be read as a PNG: {}; write the file again", path.string(), source.message);
  if (colour != PNG_COLOR_TYPE_GRAY)
    fail("{}: a height field is a grey picture, this one is coloured; write one grey channel, of 16 bits best",
         path.string());
  return field;
}

}  // namespace smelt
