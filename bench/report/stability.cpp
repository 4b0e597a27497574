#include "bench/report/stability.h"

#include "bench/cases/extremes.h"
#include "bench/report/gnuplot.h"
#include "bench/report/html.h"
#include "bench/report/jobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <map>

namespace smelt {

namespace {

using extremes::default_courant;

const std::vector<double> quick_factors{0.1, default_courant, 0.5, 1.0, 2.0},
    full_factors{0.05, 0.1, default_courant, 0.4, 0.6, 0.8, 1.0, 1.4, 2.0};
constexpr int n_map_steps = 1000;

/// Values from `low` to `high` at one ratio.
std::vector<double> geometric(double low, double high, int n) {
  std::vector<double> values;
  for (int k = 0; k < n; ++k) values.push_back(low * std::pow(high / low, static_cast<double>(k) / (n - 1)));
  return values;
}

void perform(extremes::HardScene scene, int most_steps, Trial& trial) {
  try {
    trial.seen = watch(scene.solver, scene.duration, most_steps);
  } catch (const std::exception& error) {
    trial.failure = error.what();
  }
}

Stability lay_out(bool quick) {
  Stability stability;
  for (const extremes::HardCase& hard : extremes::hard_cases()) {
    stability.cases.push_back({hard.name, {}});
    for (const double courant : quick ? quick_factors : full_factors)
      stability.cases.back().trials.push_back({.courant = courant});
  }
  for (const bool relaxed : {false, true})
    for (const double jump : geometric(1.0, 1e5, quick ? 6 : 11))
      for (const double courant : geometric(0.1, 6.4, quick ? 7 : 13))
        stability.map.push_back({jump, relaxed, {.courant = courant}});
  return stability;
}

std::string verdict(const Trial& trial) {
  if (!trial.failure.empty()) return "<span class=\"failed\">gave up: " + escape_html(trial.failure) + "</span>";
  return trial.held() ? "held" : "<span class=\"failed\">gained energy</span>";
}

std::string case_row(const HardCaseResult& result) {
  const Trial& usual = *result.at(default_courant);
  const auto held = [](const Trial& trial) { return trial.held(); };
  const auto smallest = std::find_if(result.trials.begin(), result.trials.end(), held);
  const auto largest = std::find_if(result.trials.rbegin(), result.trials.rend(), held);
  std::string row =
      fmt::format("<tr><td>{}</td><td>{}</td><td>{:.2g}</td><td>{:.2g}</td><td>{}</td>", escape_html(result.name),
                  verdict(usual), usual.seen.energy_gain, usual.seen.density_error, usual.seen.steps);
  if (smallest == result.trials.end()) return row + "<td>none</td><td></td></tr>\n";
  return row + fmt::format("<td>{:g} to {:g}</td><td>{:.2g} to {:.2g}</td></tr>\n", smallest->courant, largest->courant,
                           smallest->mean_step(), largest->mean_step());
}

/// The cells of one method by how they fared.
std::string draw_map(const std::vector<MapCell>& map, bool relaxed, const std::filesystem::path& folder) {
  Plot plot{"CFL factor C of the time step", "jump number J", true, {}, {}};
  plot.series = {{"held", {}, Series::Look::squares, 2},
                 {"gained energy", {}, Series::Look::squares, 4},
                 {"gave up", {}, Series::Look::squares, 1}};
  for (const MapCell& cell : map)
    if (cell.relaxed == relaxed)
      plot.series[!cell.trial.failure.empty() ? 2 : cell.trial.held() ? 0 : 1].curve.add(cell.trial.courant, cell.jump);
  return draw_plot(plot, relaxed ? "stability_relaxed" : "stability_explicit", folder);
}

/// The longest steps at which the block held, over the jump number, of both methods.
std::string draw_steps(const std::vector<MapCell>& map, const std::filesystem::path& folder) {
  Plot plot{"jump number J", "longest step at which it held [s]", true, {}, {}};
  for (const bool relaxed : {false, true}) {
    std::map<double, double> longest;
    for (const MapCell& cell : map)
      if (cell.relaxed == relaxed && cell.trial.held())
        longest[cell.jump] = std::max(longest[cell.jump], cell.trial.mean_step());
    plot.series.push_back({relaxed ? "relaxed stress" : "explicit: stress at once",
                           {},
                           Series::Look::line_and_points,
                           relaxed ? 0u : 1u});
    for (const auto& [jump, step] : longest) plot.series.back().curve.add(jump, step);
  }
  return draw_plot(plot, "stability_steps", folder);
}

std::string csv_row(const std::string& scene, const std::string& jump, const Trial& trial) {
  return fmt::format("\"{}\",{},{},{},{},{},{}\n", scene, jump, trial.courant, trial.seen.energy_gain,
                     trial.seen.density_error, trial.seen.steps,
                     !trial.failure.empty() ? "gave up"
                     : trial.held()         ? "held"
                                            : "gained energy");
}

}  // namespace

bool Trial::held() const {
  return failure.empty() && seen.energy_gain <= extremes::energy_bar;
}

const Trial* HardCaseResult::at(double courant) const {
  const auto found =
      std::find_if(trials.begin(), trials.end(), [&](const Trial& trial) { return trial.courant == courant; });
  return found == trials.end() ? nullptr : &*found;
}

Stability probe_stability(bool quick, unsigned threads, Progress& progress) {
  Stability stability = lay_out(quick);
  const std::size_t n_factors = stability.cases.front().trials.size(), n_hard = stability.cases.size() * n_factors;
  const auto run = [&](std::size_t k) {
    if (k < n_hard) {
      HardCaseResult& result = stability.cases[k / n_factors];
      Trial& trial = result.trials[k % n_factors];
      perform(extremes::make_hard_scene(result.name, trial.courant), std::numeric_limits<int>::max(), trial);
    } else {
      MapCell& cell = stability.map[k - n_hard];
      perform(extremes::creeping_block(cell.jump, cell.relaxed, cell.trial.courant), n_map_steps, cell.trial);
    }
  };
  const auto finished = [&](std::size_t k) {
    if (k < n_hard && (k + 1) % n_factors == 0)
      progress.message(fmt::format("stability, {}", stability.cases[k / n_factors].name));
  };
  run_jobs(n_hard + stability.map.size(), threads, progress, run, finished);
  return stability;
}

Section write_stability_section(const Stability& stability, bool quick, const std::filesystem::path& folder) {
  std::string out = fmt::format(
      "<section id=\"stability\">\n<h2>Stability</h2>\n<p>Scenes at the edge of what the method can be asked. A scene "
      "holds where it ends, finite, and no more energy comes from nowhere than {:g} % of its kinetic energy at the "
      "start. Figures are those at the CFL factor {:g}; the last two columns say between which of the factors tried it "
      "held, and how long the steps then were.</p>\n<table><tr><th>scene</th><th>verdict</th><th>energy gained / "
      "kinetic</th><th>largest density error</th><th>steps</th><th>held at CFL factors</th><th>mean step "
      "[s]</th></tr>\n",
      100.0 * extremes::energy_bar, default_courant);
  for (const HardCaseResult& result : stability.cases) out += case_row(result);
  out += "</table>\n<div class=\"plots\">\n";
  out += write_figure(
      draw_map(stability.map, false, folder),
      fmt::format(
          "The explicit method, whose stress follows the strain rate at once: a block of 216 particles that creeps, "
          "after {} steps, by CFL factor and jump number. Its step is C min(h/(c + v), h^2 rho/(8 eta)).",
          n_map_steps));
  out += write_figure(draw_map(stability.map, true, folder),
                      "The same with the relaxed stress, whose step does not depend on the viscosity.");
  out += write_figure(draw_steps(stability.map, folder),
                      "The longest steps of both maps at which the block held: what the relaxed stress is for.");
  out += fmt::format("</div>\n<p>To repeat it: <code>./smelt report stability{}</code></p>\n</section>\n",
                     quick ? " --quick" : "");
  const auto n_held = std::count_if(stability.cases.begin(), stability.cases.end(),
                                    [](const HardCaseResult& result) { return result.at(default_courant)->held(); });
  return {fmt::format(
              "<tr><td><a href=\"#stability\">Stability</a></td><td colspan=\"7\">{} of {} hard cases held</td></tr>\n",
              n_held, stability.cases.size()),
          out};
}

std::vector<std::string> failures(const Stability& stability) {
  std::vector<std::string> out;
  for (const HardCaseResult& result : stability.cases) {
    const Trial& usual = *result.at(default_courant);
    if (!usual.failure.empty())
      out.push_back(
          fmt::format("stability, {} at the CFL factor {:g} gave up: {}", result.name, default_courant, usual.failure));
    else if (!usual.held())
      out.push_back(
          fmt::format("stability, {} at the CFL factor {:g} gained {:.2g} of its kinetic energy; {:g} is allowed",
                      result.name, default_courant, usual.seen.energy_gain, extremes::energy_bar));
  }
  return out;
}

std::string write_stability_csv(const Stability& stability) {
  std::string out = "scene,jump,courant,energy_gain,density_error,steps,verdict\n";
  for (const HardCaseResult& result : stability.cases)
    for (const Trial& trial : result.trials) out += csv_row(result.name, "", trial);
  for (const MapCell& cell : stability.map)
    out += csv_row(cell.relaxed ? "block, relaxed stress" : "block, stress at once", fmt::format("{:.4g}", cell.jump),
                   cell.trial);
  return out;
}

}  // namespace smelt
