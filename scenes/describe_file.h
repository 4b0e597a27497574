#pragma once
// What a file of a shot, or a mesh, holds.

#include <filesystem>
#include <string>

namespace smelt {

/// A few lines for `smelt info`: counts, bounds, attributes; for meshes volume and whether they are closed. Throws
/// Error.
std::string describe_file(const std::filesystem::path& path);

}  // namespace smelt
