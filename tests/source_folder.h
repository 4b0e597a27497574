#pragma once

#include <filesystem>

namespace smelt {

/// The root of the source tree, where tests find data and assets.
std::filesystem::path source_folder();

}  // namespace smelt
