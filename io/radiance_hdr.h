#pragma once
// Radiance .hdr pictures.

#include "core/image.h"

#include <filesystem>

namespace smelt {

/// Reads a Radiance picture of format 32-bit_rle_rgbe with rows from the top and columns from the left (-Y height +X
/// width), flat or run-length encoded (both ways) [Ward 1991]. Values are (mantissa + 1/2) 2^(exponent - 136), and 0
/// for exponent 0. Throws Error naming the file and what is wrong with it.
RadianceImage read_radiance_hdr(const std::filesystem::path& path);

}  // namespace smelt
