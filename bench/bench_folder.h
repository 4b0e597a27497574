#pragma once

#include <filesystem>

namespace smelt {

/// The folder bench of the source tree that this program was built from, where references and expected errors lie.
std::filesystem::path bench_folder();

}  // namespace smelt
