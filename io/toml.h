#pragma once
// TOML files as trees that know their lines.

#include <toml++/toml.h>

#include <filesystem>
#include <string_view>

namespace smelt {

/// Parses a TOML file. Throws Error with file, line, column and the parser's reason.
toml::table parse_toml_file(const std::filesystem::path& path);

/// Parses TOML text; `source` names it in messages.
toml::table parse_toml(std::string_view text, std::string_view source);

}  // namespace smelt
