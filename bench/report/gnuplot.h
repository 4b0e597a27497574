#pragma once
// Plots as SVG, drawn by gnuplot (Debian package gnuplot-nox).

#include "bench/cases/case.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace smelt {

/// One curve of a plot. Points at which x or y is not a number, or not positive on a logarithmic axis, are left out.
struct Series {
  enum class Look { line, points, small_points, line_and_points, dashes, squares, reference };
  std::string label;  ///< in the legend; empty: not there
  Curve curve;
  Look look = Look::line;
  std::size_t colour = 0;  ///< of the palette, the same number the same in every plot; a reference is black
};

struct Plot {
  std::string x_label, y_label;
  bool logarithmic = false;  ///< both axes
  std::vector<Series> series;
  std::vector<double> levels;  ///< horizontal lines: good numbers
};

/// Throws Error where gnuplot cannot be started.
void check_gnuplot();

/// The plot as an `<svg>` element to stand in a page. `name` makes its ids unique there. gnuplot's script stands in
/// `folder` while it runs, and stays where gnuplot fails, which throws Error.
std::string draw_plot(const Plot& plot, const std::string& name, const std::filesystem::path& folder);

/// The same for a picture, its axes to one scale.
std::string draw_picture(const Picture& picture, const std::string& name, const std::filesystem::path& folder);

}  // namespace smelt
