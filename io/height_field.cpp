#include "io/height_field.h"

#include "core/error.h"
#include "io/extension.h"

namespace smelt {

bool is_height_field(const std::filesystem::path& path) {
  const std::string extension = lower_case_extension(path);
  return extension == ".asc" || extension == ".csv" || extension == ".png";
}

HeightField read_height_field(const std::filesystem::path& path, const HeightScale& scale) {
  const std::string extension = lower_case_extension(path);
  HeightField field;
  if (extension == ".asc")
    field = read_esri_grid(path, scale);
  else if (extension == ".csv")
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
