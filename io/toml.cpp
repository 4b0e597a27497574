#include "io/toml.h"

#include "core/error.h"
#include "io/atomic_file.h"

namespace smelt {

toml::table parse_toml_file(const std::filesystem::path& path) {
  return parse_toml(read_file(path), path.string());
}

toml::table parse_toml(std::string_view text, std::string_view source) {
  try {
    return toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    fail("{}:{}:{}: not valid TOML: {}", source, error.source().begin.line, error.source().begin.column,
         error.description());
  }
}

}  // namespace smelt
