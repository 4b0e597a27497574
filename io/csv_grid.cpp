#include "io/atomic_file.h"
#include "io/height_field.h"
#include "io/number_rows.h"

namespace smelt {

HeightField read_csv_grid(const std::filesystem::path& path, const HeightScale& scale) {
  if (!scale.cell)
    fail("{}: a .csv file does not say how far apart its heights are; give [collider.terrain] cell_m", path.string());
  const std::string text = read_file(path);
  std::string_view rest = without_byte_order_mark(text);
  HeightField field;
  field.cell = *scale.cell;
  for (std::size_t line_number = 1; !rest.empty(); ++line_number) {
    std::string_view line = take_line(rest);
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string_view::npos || line[begin] == '#') continue;
    std::size_t column = 0;
    for (std::string_view word; !(word = take_word(line, " \t,;")).empty(); ++column)
      field.height.push_back(scale.factor * to_height(word, fmt::format("{}:{}: row {}, column {}", path.string(),
                                                                        line_number, field.n_rows + 1, column + 1)));
    if (field.n_rows == 0) field.n_columns = column;
    if (column != field.n_columns)
      fail("{}:{}: row {} has {} heights, the first row {}", path.string(), line_number, field.n_rows + 1, column,
           field.n_columns);
    ++field.n_rows;
  }
  return field;
}

}  // namespace smelt
