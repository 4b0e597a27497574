#pragma once
// Lines of numbers, as text formats of grids have them.

#include "core/error.h"

#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

namespace smelt {

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

/// The whole of `word` as a finite number; throws Error that begins with `where`.
inline double to_number(std::string_view word, const std::string& where) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size())
    fail("{}: expected a number, found \"{}\"", where, word);
  if (!std::isfinite(value))
    fail("{}: the height is {}; a terrain's must be finite, fill the gap in the data", where, word);
  return value;
}

}  // namespace smelt
