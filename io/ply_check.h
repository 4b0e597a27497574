#pragma once
// A look at PLY files before assimp reads them: it loops for ever on truncated ones.

#include <filesystem>

namespace smelt {

/// Walks through a PLY file (ASCII or binary) and throws Error with the path where the header is malformed or the file
/// ends before all the elements that the header promises.
void check_ply(const std::filesystem::path& path);

}  // namespace smelt
