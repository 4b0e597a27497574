#include "io/ply_header.h"

#include "core/error.h"

#include <algorithm>
#include <optional>
#include <sstream>
#include <utility>

namespace smelt {

namespace {

std::optional<std::size_t> size_of_type(std::string_view type) {
  constexpr std::pair<std::string_view, std::size_t> sizes[] = {
      {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
      {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto* const it =
      std::find_if(std::begin(sizes), std::end(sizes), [&](const auto& s) { return s.first == type; });
  return it == std::end(sizes) ? std::nullopt : std::optional(it->second);
}

/// "float x" or "list uchar int vertex_indices".
std::optional<PlyProperty> read_property(std::istream& words) {
  std::string type, length_type, name;
  if (!(words >> type)) return std::nullopt;
  if (type == "list" && !(words >> length_type >> type)) return std::nullopt;
  const auto size = size_of_type(type), length_size = length_type.empty() ? 0 : size_of_type(length_type);
  if (!(words >> name) || !size || !length_size) return std::nullopt;
  return PlyProperty{name, type, *size, *length_size};
}

}  // namespace

PlyHeader read_ply_header(const std::filesystem::path& path, const std::string& text) {
  PlyHeader header;
  for (std::size_t begin = 0, number = 1;; ++number) {
    const std::size_t end = text.find('\n', begin);
    if (end == std::string::npos)
      fail("{}: the PLY header does not end: the file is truncated; export the mesh again", path.string());
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    std::istringstream words(line);
    std::string keyword, word;
    words >> keyword;
    bool good = true;
    if (number == 1) {
      good = keyword == "ply";
    } else if (keyword == "format") {
      words >> word;
      good = word == "ascii" || word == "binary_little_endian" || word == "binary_big_endian";
      header.encoding = word == "ascii"               ? PlyHeader::Encoding::ascii
                        : word == "binary_big_endian" ? PlyHeader::Encoding::big_endian
                                                      : PlyHeader::Encoding::little_endian;
    } else if (keyword == "element") {
      PlyElement& element = header.elements.emplace_back();
      good = static_cast<bool>(words >> element.name >> element.count);
    } else if (keyword == "property") {
      const std::optional<PlyProperty> property = read_property(words);
      good = property && !header.elements.empty();
      if (good) header.elements.back().properties.push_back(*property);
    } else if (keyword == "end_header") {
      header.size = begin;
      return header;
    } else {
      good = keyword == "comment" || keyword == "obj_info";
    }
    if (!good)
      fail("{}:{}: '{}' is not allowed in a PLY header; export the mesh again", path.string(), number,
           line.substr(0, 80));
  }
}

}  // namespace smelt
