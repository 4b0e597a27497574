#pragma once
// The header of a PLY file.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace smelt {

struct PlyProperty {
  std::string name;
  std::string type;         ///< of the value, or of one item of the list
  std::size_t size;         ///< its bytes
  std::size_t length_size;  ///< bytes of the list's length; 0 for a scalar
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  enum class Encoding { ascii, little_endian, big_endian };
  Encoding encoding = Encoding::ascii;
  std::vector<PlyElement> elements;
  std::size_t size = 0;  ///< bytes up to the first element
};

/// Throws Error with path and line where `text`, the file at `path`, does not begin with a sound header.
PlyHeader read_ply_header(const std::filesystem::path& path, const std::string& text);

}  // namespace smelt
