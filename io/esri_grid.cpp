#include "io/atomic_file.h"
#include "io/extension.h"
#include "io/height_field.h"
#include "io/number_rows.h"

#include <cctype>
#include <optional>

namespace smelt {

namespace {

constexpr std::string_view blanks = " \t";

struct Header {
  std::optional<double> n_columns, n_rows, cell, no_data;
};

double to_cell(double value, const std::string& where) {
  if (!std::isfinite(value)) fail("{}: cellsize must be a finite number of metres, is {}", where, value);
  return value;
}

/// Whether the line was one of the header's.
bool read_header_line(std::string_view line, const std::string& where, Header& header) {
  const std::string key = lower_case(take_word(line, blanks));
  if (key.empty() || !std::isalpha(static_cast<unsigned char>(key[0])) || key == "nan" || key == "inf") return false;
  const auto number = [&] { return to_number(take_word(line, blanks), where + ": " + key); };
  if (key == "ncols")
    header.n_columns = number();
  else if (key == "nrows")
    header.n_rows = number();
  else if (key == "cellsize")
    header.cell = to_cell(number(), where);
  else if (key == "nodata_value")
    header.no_data = number();
  else if (key != "xllcorner" && key != "yllcorner" && key != "xllcenter" && key != "yllcenter")
    fail(
        "{}: \"{}\" is no key of an ESRI ASCII grid; known are ncols, nrows, xllcorner, yllcorner, xllcenter, "
        "yllcenter, cellsize, NODATA_value",
        where, key);
  return true;
}

/// nan is a common mark of missing values.
bool is_same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

std::size_t to_count(const std::optional<double>& value, const char* key, const std::string& path) {
  if (!value) fail("{}: the header lacks {}; is it an ESRI ASCII grid?", path, key);
  if (!(*value >= 1.0 && *value <= 1e5 && *value == std::floor(*value)))
    fail("{}: {} must be a whole number from 1 to 100000, is {}", path, key, *value);
  return static_cast<std::size_t>(*value);
}

}  // namespace

HeightField read_esri_grid(const std::filesystem::path& path, const HeightScale& scale) {
  const std::string text = read_file(path);
  std::string_view rest = without_byte_order_mark(text);
  std::size_t line_number = 0;
  const auto where = [&] { return fmt::format("{}:{}", path.string(), line_number); };

  Header header;
  std::string_view line;
  do {
    line = take_line(rest);
    ++line_number;
  } while ((line.find_first_not_of(blanks) == std::string_view::npos || read_header_line(line, where(), header)) &&
           !rest.empty());

  HeightField field;
  field.n_columns = to_count(header.n_columns, "ncols", path.string());
  field.n_rows = to_count(header.n_rows, "nrows", path.string());
  if (!header.cell && !scale.cell) fail("{}: the header lacks cellsize; give [collider.terrain] cell_m", path.string());
  field.cell = scale.cell.value_or(header.cell.value_or(0.0));
  for (std::size_t row = 0; row < field.n_rows; ++row) {
    for (std::size_t column = 0;; ++column) {
      const std::string_view word = take_word(line, blanks);
      if (word.empty() && column == field.n_columns) break;
      if (word.empty() || column == field.n_columns)
        fail("{}: row {} has {} {} heights; ncols says {}", where(), row + 1, word.empty() ? "only" : "more than",
             column, field.n_columns);
      const std::string place = fmt::format("{}: row {}, column {}", where(), row + 1, column + 1);
      if (header.no_data && is_same(to_number(word, place), *header.no_data))
        fail("{}: NODATA ({}); a terrain has no holes, fill the gap in the data", place, word);
      field.height.push_back(scale.factor * to_height(word, place));
    }
    if (row + 1 == field.n_rows) break;
    do {
      if (rest.empty())
        fail("{}: the file ends after {} rows of heights; nrows says {}", where(), row + 1, field.n_rows);
      line = take_line(rest);
      ++line_number;
    } while (line.find_first_not_of(blanks) == std::string_view::npos);
  }
  if (rest.find_first_not_of(" \t\r\n") != std::string_view::npos)
    fail("{}: there is more after the last of the {} rows that nrows gives", where(), field.n_rows);
  return field;
}

}  // namespace smelt
