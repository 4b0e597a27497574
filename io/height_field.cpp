#include "io/height_field.h"

#include "core/error.h"

namespace smelt {

bool is_height_field(const std::filesystem::path& path) {
  return path.extension() == ".asc" || path.extension() == ".csv" || path.extension() == ".png";
}

HeightField read_height_field(const std::filesystem::path& path, const HeightScale& scale) {
  HeightField field;
  if (path.extension() == ".asc")
    field = read_esri_grid(path, scale);
  else if (path.extension() == ".csv")
    field = read_csv_grid(path, scale);
  else
    field = read_height_png(path, scale);
  if (field.n_columns < 2 || field.n_rows < 2)
    fail("{}: a terrain needs at least 2 x 2 heights, this file has {} x {}", path.string(), field.n_columns,
         field.n_rows);
  if (!(field.cell > 0.0)) fail("{}: the distance between heights must be > 0, is {} m", path.string(), field.cell);
  return field;
}

}  // namespace smelt
