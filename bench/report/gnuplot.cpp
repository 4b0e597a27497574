#include "bench/report/gnuplot.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/run_program.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

namespace smelt {

namespace {

// Okabe and Ito's, told apart by colour-blind readers too.
constexpr std::array palette{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};

/// In gnuplot's single quotes, where only those are doubled.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

std::string style_of(const Series& series) {
  const char* colour = palette[series.colour % palette.size()];
  switch (series.look) {
    case Series::Look::line:
      return fmt::format("with lines lw 2 lc rgb '{}'", colour);
    case Series::Look::points:
      return fmt::format("with points pt 7 ps 0.8 lc rgb '{}'", colour);
    case Series::Look::small_points:
      return fmt::format("with points pt 7 ps 0.35 lc rgb '{}'", colour);
    case Series::Look::line_and_points:
      return fmt::format("with linespoints lw 2 pt 7 ps 0.8 lc rgb '{}'", colour);
    case Series::Look::squares:
      return fmt::format("with points pt 5 ps 1.6 lc rgb '{}'", colour);
    case Series::Look::reference:
      return "with lines lw 1.5 lc rgb '#222222'";
    case Series::Look::dashes:
      return fmt::format("with lines lw 1 dt 2 lc rgb '{}'", colour);
  }
  throw InternalError("style_of: unknown look");
}

std::string head(const std::string& name, int width, int height) {
  return fmt::format(
      "set terminal svg name '{}' size {},{} dynamic noenhanced font 'sans-serif,13' background rgb 'white'\n"
      "set border lc rgb '#555555'\nset grid lc rgb '#dddddd'\nset tics nomirror\n",
      name, width, height);
}

std::string labels(const std::string& x, const std::string& y) {
  return fmt::format("set xlabel {}\nset ylabel {}\n", quoted(x), quoted(y));
}

bool can_be_drawn(double x, double y, bool logarithmic) {
  return std::isfinite(x) && std::isfinite(y) && (!logarithmic || (x > 0.0 && y > 0.0));
}

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;

  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

/// A plot on its way to gnuplot.
struct Script {
  std::string data, plots;
  Range x, y;
  int n_series = 0;

  void add(const Series& series, bool logarithmic) {
    std::string rows;
    for (std::size_t i = 0; i < series.curve.x.size(); ++i) {
      const double x_i = series.curve.x[i], y_i = series.curve.y[i];
      if (!can_be_drawn(x_i, y_i, logarithmic)) continue;
      x.add(x_i);
      y.add(y_i);
      fmt::format_to(std::back_inserter(rows), "{:.6g} {:.6g}\n", x_i, y_i);
    }
    if (rows.empty()) return;
    const std::string name = fmt::format("$d{}", n_series++);
    data += fmt::format("{} << EOD\n{}EOD\n", name, rows);
    add_plot(fmt::format("{} {} {}", name, style_of(series),
                         series.label.empty() ? "notitle" : "title " + quoted(series.label)));
  }

  void add_plot(const std::string& command) { plots += (plots.empty() ? "plot " : ", ") + command; }
};

/// The digits of a decade at which an axis has numbers: the fewer, the more it spans.
std::vector<double> digits_for(double span) {
  if (span > 1e3) return {1.0};
  if (span > 8.0) return {1.0, 2.0, 5.0};
  return {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0};
}

/// Range and tics of an axis, a third beyond the data on either side: gnuplot's own tics stand at whole decades, of
/// which the data may span less than one.
std::string logarithmic_axis(char axis, const Range& range) {
  const double low = range.low / 1.33, high = range.high * 1.33;
  std::string tics;
  for (double decade = std::pow(10.0, std::floor(std::log10(low))); decade <= high; decade *= 10.0)
    for (const double digit : digits_for(high / low)) {
      const double at = digit * decade;
      if (at >= low && at <= high) tics += fmt::format("{0}'{1:.4g}' {1:.4g}", tics.empty() ? "" : ", ", at);
    }
  return fmt::format("set {0}range [{1:.6g}:{2:.6g}]\nset {0}tics ({3})\n", axis, low, high, tics);
}

/// Runs a script, and takes the `<svg>` element that it drew.
std::string run_script(std::string script, const std::string& name, const std::filesystem::path& folder) {
  const auto script_path = folder / (name + ".gnuplot"), svg_path = folder / (name + ".svg");
  script.insert(0, fmt::format("set output {}\n", quoted(svg_path.string())));
  write_file_atomically(script_path, script);
  const int status = run_program({"gnuplot", script_path.string()});
  if (status != 0) fail("gnuplot failed with status {}; its script is {}", status, script_path.string());
  std::string svg = read_file(svg_path);
  std::filesystem::remove(script_path);
  std::filesystem::remove(svg_path);
  const std::size_t begin = svg.find("<svg");
  if (begin == std::string::npos) fail("gnuplot wrote no <svg> element for {}", name);
  return svg.substr(begin);  // without the XML declaration, which only a whole file may have
}

}  // namespace

void check_gnuplot() {
  if (run_program({"gnuplot", "--version"}) != 0)
    fail(
        "the report's plots need gnuplot, and it cannot be started: `./smelt report` installs it, or install the "
        "package gnuplot-nox");
}

std::string draw_plot(const Plot& plot, const std::string& name, const std::filesystem::path& folder) {
  Script script;
  for (const Series& series : plot.series) script.add(series, plot.logarithmic);
  if (script.plots.empty()) return "<p>Nothing to draw.</p>";
  for (std::size_t k = 0; k < plot.levels.size(); ++k) {
    script.y.add(plot.levels[k]);
    script.add_plot(fmt::format("{:.6g} with lines lw 1 dt 3 lc rgb '#555555' {}", plot.levels[k],
                                k == 0 ? "title 'a good number'" : "notitle"));
  }
  std::string settings = head(name, 520, 400) + labels(plot.x_label, plot.y_label) +
                         "set key outside above Left reverse horizontal samplen 2\n";
  if (plot.logarithmic)
    settings += "set logscale xy\n" + logarithmic_axis('x', script.x) + logarithmic_axis('y', script.y);
  else
    settings += "set offsets graph 0.03, graph 0.03, graph 0.03, graph 0.03\nset autoscale noextend\n";
  return run_script(settings + script.data + script.plots + "\n", name, folder);
}

std::string draw_picture(const Picture& picture, const std::string& name, const std::filesystem::path& folder) {
  std::string script = head(name, 720, 400) + labels(picture.x_label, picture.y_label);
  script += fmt::format(
      "set size ratio -1\nset palette defined (0 '#2b4b9b', 0.5 '#5fb3a1', 1 '#f2c84b')\nset cblabel {}\nunset key\n$d "
      "<< EOD\n",
      quoted(picture.value_label));
  for (std::size_t i = 0; i < picture.x.size(); ++i)
    fmt::format_to(std::back_inserter(script), "{:.5g} {:.5g} {:.4g}\n", picture.x[i], picture.y[i], picture.value[i]);
  return run_script(script + "EOD\nplot $d with points pt 7 ps 0.4 lc palette\n", name, folder);
}

}  // namespace smelt
