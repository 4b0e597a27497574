#pragma once
// Lines of numbers, as text formats of grids and particles have them.

#include "core/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

namespace smelt {

/// `text` without the byte order mark that some programs put before UTF-8.
inline std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xef\xbb\xbf";
  if (text.starts_with(mark)) text.remove_prefix(mark.size());
  return text;
}

/// The next line of `text`, taken off it, without its end.
inline std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

/// The next word of `line`, taken off it; empty at its end.
inline std::string_view take_word(std::string_view& line, std::string_view separators) {
  const std::size_t begin = std::min(line.find_first_not_of(separators), line.size());
  const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

/// The whole of `word` as a number, which may have a sign and be nan or inf; nothing where it is none.
inline std::optional<double> parse_number(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// The same; throws Error that begins with `where`.
inline double to_number(std::string_view word, const std::string& where) {
  const std::optional<double> value = parse_number(word);
  if (!value) fail("{}: expected a number, found \"{}\"", where, word);
  return *value;
}

/// A height of a terrain; throws Error that begins with `where`, too where it is not finite.
inline double to_height(std::string_view word, const std::string& where) {
  const double value = to_number(word, where);
  if (!std::isfinite(value))
    fail("{}: the height is {}; a terrain's must be finite, fill the gap in the data", where, word);
  return value;
}

}  // namespace smelt
