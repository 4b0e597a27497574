#pragma once
// PNG files.

#include "core/image.h"

#include <filesystem>

namespace smelt {

/// Writes an 8-bit sRGB PNG, all or nothing: the file appears complete or not at all. The same pixels give the same
/// bytes. Throws Error naming the file if the image is empty or its size and pixels disagree, or if it cannot be
/// written.
void write_png(const std::filesystem::path& path, const ImageRgb8& image);

/// The same with 16 bits a channel.
void write_png(const std::filesystem::path& path, const ImageRgb16& image);

/// Reads any PNG as 8-bit RGB; transparency is dropped. Throws Error naming the file if it is missing or no sound PNG.
ImageRgb8 read_png(const std::filesystem::path& path);

}  // namespace smelt
