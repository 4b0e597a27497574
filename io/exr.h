#pragma once
// OpenEXR files.

#include "core/image.h"

#include <filesystem>

namespace smelt {

/// Writes a scan-line file, ZIP-compressed, all or nothing: colours (channels R, G, B, A, alone or of a layer) as half
/// floats, everything else as floats. The same image gives the same bytes. Throws Error naming the file where the
/// channels do not fit the size or it cannot be written.
void write_exr(const std::filesystem::path& path, const LayeredImage& image);

/// All channels of a flat file, as floats, in the order of their names. Throws Error naming the file.
LayeredImage read_exr(const std::filesystem::path& path);

/// A panorama or other picture of radiance: the channels R, G and B of an .exr, or a Radiance .hdr. Throws Error naming
/// the file where it is neither, damaged, or holds what no light can be (negative or not finite).
RadianceImage read_radiance(const std::filesystem::path& path);

}  // namespace smelt
