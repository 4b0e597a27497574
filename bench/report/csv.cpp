#include "bench/report/csv.h"

#include <fmt/format.h>

#include <iterator>

namespace smelt {

namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

void append_curve(std::string& out, const std::string& begin, const char* series, const Curve& curve) {
  for (std::size_t i = 0; i < curve.x.size(); ++i)
    fmt::format_to(std::back_inserter(out), "{},{},{},{}\n", begin, series, curve.x[i], curve.y[i]);
}

}  // namespace

std::vector<RunRow> to_rows(const CaseResult& result) {
  std::vector<RunRow> rows;
  for (const Run& run : result.runs)
    rows.push_back({result.problem.name, result.problem.methods[run.method], run.resolution, run.measured.n_particles,
                    run.measured.error, run.measured.cpu_seconds, run.failure});
  return rows;
}

std::string write_runs_csv(const std::vector<RunRow>& rows) {
  std::string out = "case,method,resolution,particles,error,cpu_seconds,failure\n";
  for (const RunRow& row : rows) {
    out += fmt::format("{},{},{},", quoted(row.problem), quoted(row.method), row.resolution);
    if (row.failure.empty())
      out += fmt::format("{},{},{},\n", row.n_particles, row.error, row.cpu_seconds);
    else
      out += fmt::format(",,,{}\n", quoted(row.failure));
  }
  return out;
}

std::string write_profiles_csv(const CaseResult& result) {
  const Case& problem = result.problem;
  std::string out;
  for (const Run& run : result.runs) {
    if (run.failed() || !run.measured.profile) continue;
    const std::string begin = fmt::format("{},{}", quoted(problem.methods[run.method]), run.resolution);
    append_curve(out, begin, "computed", run.measured.profile->computed);
    append_curve(out, begin, "reference", run.measured.profile->reference);
  }
  if (out.empty()) return out;
  return fmt::format("method,resolution,series,{},{}\n", quoted(problem.profile_x), quoted(problem.profile_y)) + out;
}

}  // namespace smelt
