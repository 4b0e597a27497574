#pragma once
// Height fields from files: ESRI ASCII grids (.asc), tables of numbers (.csv) and grey PNG pictures (.png).

#include "core/geometry/height_field.h"

#include <filesystem>
#include <optional>

namespace smelt {

/// How the numbers of a file become metres.
struct HeightScale {
  std::optional<double> cell;  ///< distance between heights [m]; an .asc file says it itself
  double factor = 1.0;         ///< of .asc and .csv: number times factor [m]
  double lowest = 0.0;         ///< of .png: black [m], and
  double highest = 1.0;        ///< white [m]
};

/// Whether the name ends as that of a height field does.
bool is_height_field(const std::filesystem::path& path);

/// Reads a height field of any of the formats. The first row is the northern one. Throws Error with file, line or row
/// and column for what is missing, no number, not finite or marked as NODATA, for rows of unequal length, and for a
/// damaged picture.
HeightField read_height_field(const std::filesystem::path& path, const HeightScale& scale);

/// ESRI ASCII grid: ncols, nrows, corner or centre, cellsize, NODATA_value, then a line of heights for each row. Where
/// on the earth it lies is left aside.
HeightField read_esri_grid(const std::filesystem::path& path, const HeightScale& scale);

/// A line of numbers for each row, parted by commas, semicolons, tabs or blanks; lines that begin with # are left out.
HeightField read_csv_grid(const std::filesystem::path& path, const HeightScale& scale);

/// A grey picture of 8 or 16 bits; its numbers are taken as they are, without gamma.
HeightField read_height_png(const std::filesystem::path& path, const HeightScale& scale);

}  // namespace smelt
