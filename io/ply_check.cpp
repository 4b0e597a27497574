#include "io/ply_check.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/ply_header.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>

namespace smelt {
namespace {

/// Steps over values; false where the file ends first.
class Walker {
 public:
  Walker(PlyHeader::Encoding encoding, std::string_view body) : encoding_(encoding), rest_(body) {}

  bool skip(const PlyProperty& property) {
    std::uint64_t n = 1;
    if (property.length_size > 0 && !read_length(property.length_size, n)) return false;
    if (encoding_ != PlyHeader::Encoding::ascii) return skip_bytes(n, property.size);
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
    if (encoding_ == PlyHeader::Encoding::ascii) {
      const std::string_view word = next_word();
      return std::from_chars(word.data(), word.data() + word.size(), length).ec == std::errc();
    }
    if (rest_.size() < size) return false;
    length = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const std::size_t byte = encoding_ == PlyHeader::Encoding::big_endian ? k : size - 1 - k;
      length = length << 8 | static_cast<unsigned char>(rest_[byte]);
    }
    rest_.remove_prefix(size);
    return true;
  }

  PlyHeader::Encoding encoding_;
  std::string_view rest_;
};

}  // namespace

void check_ply(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  const PlyHeader header = read_ply_header(path, text);
  Walker walker(header.encoding, std::string_view(text).substr(header.size));
  for (const PlyElement& element : header.elements)
    for (std::uint64_t i = 0; i < element.count && !element.properties.empty(); ++i)
      for (const PlyProperty& property : element.properties)
        if (!walker.skip(property))
          fail("{}: ends in {} {} of the {} that its header promises: the file is truncated; export the mesh again",
               path.string(), element.name, i + 1, element.count);
}

}  // namespace smelt
