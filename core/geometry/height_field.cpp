#include "core/geometry/height_field.h"

#include "core/error.h"

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

void check_field(const HeightField& field) {
  if (field.n_columns < 2 || field.n_rows < 2)
    fail("a terrain needs at least 2 x 2 heights, this one has {} x {}", field.n_columns, field.n_rows);
  if (!(field.cell > 0.0)) fail("the heights of a terrain must be a distance > 0 apart, is {} m", field.cell);
  CHECK_EQ(field.height.size(), field.n_columns * field.n_rows);
}

/// Catmull-Rom cubic between p1 (t = 0) and p2 (t = 1).
double cubic(double p0, double p1, double p2, double p3, double t) {
  const double a = -0.5 * p0 + 1.5 * p1 - 1.5 * p2 + 0.5 * p3, b = p0 - 2.5 * p1 + 2.0 * p2 - 0.5 * p3,
               c = 0.5 * (p2 - p0);
  return ((a * t + b) * t + c) * t + p1;
}

/// `count` values `stride` apart, with n steps for each of theirs; beyond the ends the line goes on straight.
std::vector<double> refine_line(const double* values, std::size_t count, std::size_t stride, int n) {
  const auto at = [&](std::ptrdiff_t i) {
    const auto last = static_cast<std::ptrdiff_t>(count) - 1, step = static_cast<std::ptrdiff_t>(stride);
    if (i < 0) return 2.0 * values[0] - values[step];
    if (i > last) return 2.0 * values[last * step] - values[(last - 1) * step];
    return values[i * step];
  };
  std::vector<double> result;
  for (std::size_t i = 0; i + 1 < count; ++i)
    for (int k = 0; k < n; ++k) {
      const auto s = static_cast<std::ptrdiff_t>(i);
      result.push_back(cubic(at(s - 1), at(s), at(s + 1), at(s + 2), static_cast<double>(k) / n));
    }
  result.push_back(values[(count - 1) * stride]);
  return result;
}

/// Indices of the rim's vertices, counter-clockwise seen from above (with x to the right and z towards the viewer).
std::vector<std::uint32_t> rim_of(const HeightField& field) {
  const auto index = [&](std::size_t column, std::size_t row) {
    return static_cast<std::uint32_t>(row * field.n_columns + column);
  };
  const std::size_t last_column = field.n_columns - 1, last_row = field.n_rows - 1;
  std::vector<std::uint32_t> rim;
  for (std::size_t c = 0; c < last_column; ++c) rim.push_back(index(c, last_row));
  for (std::size_t r = last_row; r > 0; --r) rim.push_back(index(last_column, r));
  for (std::size_t c = last_column; c > 0; --c) rim.push_back(index(c, 0));
  for (std::size_t r = 0; r < last_row; ++r) rim.push_back(index(0, r));
  return rim;
}

}  // namespace

HeightField refine(const HeightField& field, int n) {
  check_field(field);
  CHECK_GE(n, 1);
  if (n == 1) return field;
  const auto fine = [n](std::size_t count) { return (count - 1) * static_cast<std::size_t>(n) + 1; };
  const std::size_t columns = fine(field.n_columns), rows = fine(field.n_rows);
  std::vector<double> wide;
  for (std::size_t r = 0; r < field.n_rows; ++r) {
    const auto row = refine_line(field.height.data() + r * field.n_columns, field.n_columns, 1, n);
    wide.insert(wide.end(), row.begin(), row.end());
  }
  HeightField result{columns, rows, field.cell / n, std::vector<double>(columns * rows)};
  for (std::size_t c = 0; c < columns; ++c) {
    const auto column = refine_line(wide.data() + c, field.n_rows, columns, n);
    for (std::size_t r = 0; r < rows; ++r) result.height[r * columns + c] = column[r];
  }
  return result;
}

TriangleMesh make_terrain_sheet(const HeightField& field) {
  check_field(field);
  TriangleMesh mesh;
  const double west = -0.5 * field.cell * static_cast<double>(field.n_columns - 1);
  const double north = -0.5 * field.cell * static_cast<double>(field.n_rows - 1);
  for (std::size_t r = 0; r < field.n_rows; ++r)
    for (std::size_t c = 0; c < field.n_columns; ++c) {
      if (!std::isfinite(field.at(c, r))) fail("the height of row {}, column {} is not a finite number", r + 1, c + 1);
      mesh.vertices.emplace_back(west + field.cell * static_cast<double>(c), field.at(c, r),
                                 north + field.cell * static_cast<double>(r));
    }
  for (std::size_t r = 0; r + 1 < field.n_rows; ++r)
    for (std::size_t c = 0; c + 1 < field.n_columns; ++c) {
      const auto nw = static_cast<std::uint32_t>(r * field.n_columns + c), ne = nw + 1;
      const auto sw = nw + static_cast<std::uint32_t>(field.n_columns), se = sw + 1;
      if (std::abs(field.height[nw] - field.height[se]) <= std::abs(field.height[ne] - field.height[sw])) {
        mesh.triangles.push_back({nw, sw, se});
        mesh.triangles.push_back({nw, se, ne});
      } else {
        mesh.triangles.push_back({nw, sw, ne});
        mesh.triangles.push_back({ne, sw, se});
      }
    }
  return mesh;
}

TriangleMesh make_terrain_solid(const HeightField& field, double bottom) {
  TriangleMesh mesh = make_terrain_sheet(field);
  const double lowest = *std::min_element(field.height.begin(), field.height.end());
  if (!(bottom < lowest))
    fail("the bottom of a terrain must be below its lowest height, {} m, is at {} m", lowest, bottom);
  const std::vector<std::uint32_t> rim = rim_of(field);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const std::uint32_t v : rim) mesh.vertices.emplace_back(mesh.vertices[v][0], bottom, mesh.vertices[v][2]);
  const auto centre = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.emplace_back(0.0, bottom, 0.0);
  for (std::uint32_t k = 0; k < rim.size(); ++k) {
    const std::uint32_t next = (k + 1) % static_cast<std::uint32_t>(rim.size());
    mesh.triangles.push_back({rim[k], first + k, first + next});
    mesh.triangles.push_back({rim[k], first + next, rim[next]});
    mesh.triangles.push_back({centre, first + next, first + k});
  }
  return mesh;
}

}  // namespace smelt
