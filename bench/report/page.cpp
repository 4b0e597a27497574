#include "bench/report/page.h"

#include "bench/cases/norms.h"
#include "bench/report/gnuplot.h"
#include "bench/report/html.h"
#include "scenes/machine.h"

#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <iterator>
#include <set>
#include <thread>

namespace smelt {

namespace {

constexpr const char* style = R"(
  body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 1120px; margin: 2em auto; padding: 0 1em; }
  h2 { margin-top: 2.5em; border-top: 1px solid #ccc; padding-top: 1em; }
  figure { margin: 0; flex: 1 1 480px; min-width: 0; }
  figcaption { font-size: 14px; color: #555; }
  svg { width: 100%; height: auto; }
  .plots { display: flex; flex-wrap: wrap; gap: 1em; }
  table { border-collapse: collapse; font-size: 14px; margin: 1em 0; }
  td, th { border-bottom: 1px solid #ddd; padding: 2px 10px; text-align: right; }
  td:first-child, th:first-child { text-align: left; }
  td:nth-child(n + 3) { white-space: nowrap; }
  code { background: #f3f3f3; padding: 1px 4px; }
  .failed { color: #a00; font-weight: bold; }
)";

/// Of the runs of a method that went well, `y` over `x`.
template <typename X, typename Y>
Curve collect(const std::vector<Run>& runs, std::size_t method, const X& x, const Y& y) {
  Curve curve;
  for (const Run& run : runs) {
    if (run.method != method || run.failed()) continue;
    curve.x.push_back(x(run));
    curve.y.push_back(y(run));
  }
  return curve;
}

double error_of(const Run& run) {
  return run.measured.error;
}

/// Each number once, however many methods it is for.
std::vector<double> distinct_good_errors(const Case& problem) {
  const std::set<double> distinct(problem.good_errors.begin(), problem.good_errors.end());
  return {distinct.begin(), distinct.end()};
}

Plot cost_plot(const CaseResult& result) {
  const Case& problem = result.problem;
  Plot plot{"CPU seconds", problem.error_label, true, {}, distinct_good_errors(problem)};
  for (std::size_t m = 0; m < problem.methods.size(); ++m)
    plot.series.push_back({problem.methods[m],
                           collect(
                               result.runs, m, [](const Run& run) { return run.measured.cpu_seconds; }, error_of),
                           Series::Look::line_and_points, m});
  return plot;
}

/// The line C resolution^-order through the middle of a curve in the logarithms.
Curve fitted_line(const Curve& curve, double order) {
  double log_c = 0.0;
  const auto n = static_cast<double>(curve.x.size());
  for (std::size_t k = 0; k < curve.x.size(); ++k) log_c += (std::log(curve.y[k]) + order * std::log(curve.x[k])) / n;
  Curve line;
  for (const double x : {curve.x.front(), curve.x.back()}) {
    line.x.push_back(x);
    line.y.push_back(std::exp(log_c - order * std::log(x)));
  }
  return line;
}

Plot convergence_plot(const CaseResult& result) {
  const Case& problem = result.problem;
  Plot plot{problem.resolution_label, problem.error_label, true, {}, distinct_good_errors(problem)};
  for (std::size_t m = 0; m < problem.methods.size(); ++m) {
    const Curve curve = collect(
        result.runs, m, [](const Run& run) { return run.resolution; }, error_of);
    const auto order = fitted_order(result.runs, m);
    const std::string label = problem.methods[m] + (order ? fmt::format(", order {:.2f}", *order) : "");
    plot.series.push_back({label, curve, Series::Look::points, m});
    if (order) plot.series.push_back({"", fitted_line(curve, *order), Series::Look::dashes, m});
  }
  return plot;
}

/// The finest run of a method that went well and that `has` what is looked for.
template <typename Has>
const Run* finest(const std::vector<Run>& runs, std::size_t method, const Has& has) {
  const Run* best = nullptr;
  for (const Run& run : runs)
    if (run.method == method && !run.failed() && has(run.measured)) best = &run;
  return best;
}

Plot profile_plot(const CaseResult& result) {
  const Case& problem = result.problem;
  Plot plot{problem.profile_x, problem.profile_y, false, {}, {}};
  std::vector<Series> references;
  for (std::size_t m = 0; m < problem.methods.size(); ++m) {
    const Run* run = finest(result.runs, m, [](const Measurement& measured) { return measured.profile.has_value(); });
    if (run == nullptr) continue;
    const Profile& profile = *run->measured.profile;
    const bool crowded = profile.computed.x.size() > 40;
    plot.series.push_back({fmt::format("{} at {:g}", problem.methods[m], run->resolution), profile.computed,
                           crowded ? Series::Look::small_points : Series::Look::points, m});
    if (references.empty() || references.back().curve.y != profile.reference.y)
      references.push_back({references.empty() ? "reference" : "", profile.reference, Series::Look::reference, 0});
  }
  plot.series.insert(plot.series.end(), references.begin(), references.end());
  return plot;
}

std::string write_figures(const CaseResult& result, const std::filesystem::path& folder) {
  const Case& problem = result.problem;
  std::string out = "<div class=\"plots\">\n";
  out += write_figure(draw_plot(cost_plot(result), problem.name + "_cost", folder),
                      "Error against CPU seconds of one thread; a point for each resolution.");
  out += write_figure(draw_plot(convergence_plot(result), problem.name + "_convergence", folder),
                      "Error against resolution, with the fitted order.");
  const Plot profile = profile_plot(result);
  if (!profile.series.empty())
    out += write_figure(draw_plot(profile, problem.name + "_profile", folder),
                        "The finest run of each method (points) beside the reference (line).");
  if (const Run* run = finest(result.runs, 0, [](const Measurement& measured) { return measured.picture.has_value(); }))
    out += write_figure(draw_picture(*run->measured.picture, problem.name + "_picture", folder),
                        run->measured.picture->caption);
  return out + "</div>\n";
}

/// The finest run of each method against the good number.
std::string write_summary(const CaseResult& result) {
  const Case& problem = result.problem;
  std::string out;
  for (std::size_t m = 0; m < problem.methods.size(); ++m) {
    out += fmt::format("<tr><td><a href=\"#{}\">{}</a></td><td>{}</td>", problem.name, escape_html(problem.title),
                       escape_html(problem.methods[m]));
    const Run* run = finest(result.runs, m, [](const Measurement&) { return true; });
    if (run == nullptr) {
      out += "<td class=\"failed\" colspan=\"6\">failed</td></tr>\n";
      continue;
    }
    const auto order = fitted_order(result.runs, m);
    out += fmt::format("<td>{:g}</td><td>{:.3g}</td><td>{:g}</td><td>{}</td><td>{}</td><td>{:.2f}</td></tr>\n",
                       run->resolution, run->measured.error, problem.good_error(m),
                       run->measured.error <= problem.good_error(m) ? "yes" : "no",
                       order ? fmt::format("{:.2f}", *order) : "", run->measured.cpu_seconds);
  }
  return out;
}

std::string write_table(const CaseResult& result) {
  const Case& problem = result.problem;
  std::string out =
      fmt::format("<table><tr><th>method</th><th>{}</th><th>particles</th><th>{}</th><th>CPU seconds</th></tr>\n",
                  escape_html(problem.resolution_label), escape_html(problem.error_label));
  for (const Run& run : result.runs) {
    out += fmt::format("<tr><td>{}</td><td>{:g}</td>", escape_html(problem.methods[run.method]), run.resolution);
    if (run.failed())
      out += fmt::format("<td class=\"failed\" colspan=\"3\">failed: {}</td></tr>\n", escape_html(run.failure));
    else
      out += fmt::format("<td>{}</td><td>{:.3g}</td><td>{:.2f}</td></tr>\n",
                         run.measured.n_particles > 0 ? fmt::to_string(run.measured.n_particles) : "",
                         run.measured.error, run.measured.cpu_seconds);
  }
  return out + "</table>\n";
}

}  // namespace

std::string describe_machine() {
  return fmt::format("{}, {} cores", cpu_name(), std::thread::hardware_concurrency());
}

std::string describe_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &utc);
  return text;
}

std::optional<double> fitted_order(const std::vector<Run>& runs, std::size_t method) {
  const Curve curve = collect(
      runs, method, [](const Run& run) { return 1.0 / run.resolution; }, error_of);
  if (curve.x.size() < 2) return std::nullopt;
  for (const double error : curve.y)
    if (!(error > 0.0) || !std::isfinite(error)) return std::nullopt;
  return convergence_order(curve.x, curve.y);
}

Section write_case_section(const CaseResult& result, bool quick, const std::filesystem::path& folder) {
  const Case& problem = result.problem;
  std::string out = fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n<p>{} {}</p>\n", problem.name,
                                escape_html(problem.title), escape_html(problem.measures), escape_html(problem.good));
  if (result.failed()) out += "<p class=\"failed\">Some of its runs failed: see the table.</p>\n";
  out += write_figures(result, folder) + write_table(result);
  out += fmt::format("<p>To repeat it: <code>./smelt report {}{}</code></p>\n</section>\n", problem.name,
                     quick ? " --quick" : "");
  return {write_summary(result), out};
}

std::string write_page(const PageHead& head, const std::vector<Section>& sections, std::size_t n_expected) {
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>smelt: speed against "
      "error</title><style>{}</style></head><body>\n<h1>smelt: speed against error</h1>\n"
      "<table><tr><td>machine</td><td>{}</td></tr><tr><td>smelt</td><td>{}</td></tr><tr><td>date</td><td>{}</td></tr>"
      "<tr><td>command</td><td><code>{}</code></td></tr></table>\n",
      style, escape_html(head.machine), escape_html(head.version), head.date, escape_html(head.command));
  out +=
      "<p>Every case has a known answer: an exact or converged solution, or an experiment. CPU seconds are those of "
      "one thread. Dotted lines in a plot are good numbers as the case's text has them; below and to the left is "
      "better.</p>\n";
  if (head.quick)
    out += "<p>These are the coarse resolutions of the quick suite; without <code>--quick</code> finer ones run.</p>\n";
  if (sections.size() < n_expected)
    out += fmt::format("<p class=\"failed\">{} of {} sections so far.</p>\n", sections.size(), n_expected);
  out +=
      "<table><tr><th>case</th><th>method</th><th>finest</th><th>error</th><th>a good "
      "number</th><th>met</th><th>order</th><th>CPU seconds</th></tr>\n";
  for (const Section& section : sections) out += section.summary;
  out += "</table>\n";
  for (const Section& section : sections) out += section.body;
  return out + "</body></html>\n";
}

}  // namespace smelt
