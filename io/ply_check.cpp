#include "io/ply_check.h"

#include "core/error.h"
#include "io/atomic_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <vector>

namespace smelt {
namespace {

struct Property {
  std::size_t size;         ///< bytes of the value, or of one item of the list
  std::size_t length_size;  ///< bytes of the list's length; 0 for a scalar
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding { ascii, little_endian, big_endian };

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::size_t size = 0;  ///< bytes up to the first element
};

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
std::optional<Property> read_property(std::istream& words) {
  std::string type, length_type, name;
  if (!(words >> type)) return std::nullopt;
  if (type == "list" && !(words >> length_type >> type)) return std::nullopt;
  const auto size = size_of_type(type), length_size = length_type.empty() ? 0 : size_of_type(length_type);
  if (!(words >> name) || !size || !length_size) return std::nullopt;
  return Property{*size, *length_size};
}

Header read_header(const std::filesystem::path& path, const std::string& text) {
  Header header;
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
      header.encoding = word == "ascii"               ? Encoding::ascii
                        : word == "binary_big_endian" ? Encoding::big_endian
                                                      : Encoding::little_endian;
    } else if (keyword == "element") {
      Element& element = header.elements.emplace_back();
      good = static_cast<bool>(words >> element.name >> element.count);
    } else if (keyword == "property") {
      const std::optional<Property> property = read_property(words);
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

/// Steps over values; false where the file ends first.
class Walker {
 public:
  Walker(Encoding encoding, std::string_view body) : encoding_(encoding), rest_(body) {}

  bool skip(const Property& property) {
    std::uint64_t n = 1;
    if (property.length_size > 0 && !read_length(property.length_size, n)) return false;
    if (encoding_ != Encoding::ascii) return skip_bytes(n, property.size);
    for (; n > 0; --n)
      if (next_word().empty()) return false;
    return true;
  }

 private:
  bool skip_bytes(std::uint64_t n, std::size_t size) {
    if (n > rest_.size() / size) return false;
    rest_.remove_prefix(static_cast<std::size_t>(n) * size);
    return true;
  }

  std::string_view next_word() {
    constexpr std::string_view blank = " \t\r\n";
    rest_.remove_prefix(std::min(rest_.find_first_not_of(blank), rest_.size()));
    const std::string_view word = rest_.substr(0, rest_.find_first_of(blank));
    rest_.remove_prefix(word.size());
    return word;
  }

  bool read_length(std::size_t size, std::uint64_t& length) {
    if (encoding_ == Encoding::ascii) {
      const std::string_view word = next_word();
      return std::from_chars(word.data(), word.data() + word.size(), length).ec == std::errc();
    }
    if (rest_.size() < size) return false;
    length = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const std::size_t byte = encoding_ == Encoding::big_endian ? k : size - 1 - k;
      length = length << 8 | static_cast<unsigned char>(rest_[byte]);
    }
    rest_.remove_prefix(size);
    return true;
  }

  Encoding encoding_;
  std::string_view rest_;
};

}  // namespace

void check_ply(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  const Header header = read_header(path, text);
  Walker walker(header.encoding, std::string_view(text).substr(header.size));
  for (const Element& element : header.elements)
    for (std::uint64_t i = 0; i < element.count && !element.properties.empty(); ++i)
      for (const Property& property : element.properties)
        if (!walker.skip(property))
          fail("{}: ends in {} {} of the {} that its header promises: the file is truncated; export the mesh again",
               path.string(), element.name, i + 1, element.count);
}

}  // namespace smelt
