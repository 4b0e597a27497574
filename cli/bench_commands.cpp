#include "cli/bench_commands.h"

#include "bench/pairs_bench.h"
#include "bench/step_bench.h"
#include "bench/thesis_bench.h"
#include "scenes/version.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace smelt {

namespace {

nlohmann::ordered_json to_json(const StepBenchResult& r) {
  nlohmann::ordered_json stages;
  for (std::size_t k = 0; k < step_stage_names.size(); ++k) stages[step_stage_names[k]] = r.stage_shares[k];
  return {{"particles", r.n_particles},
          {"neighbours", r.neighbours},
          {"seconds_per_step", r.seconds_per_step},
          {"particle_steps_per_second", r.particle_steps_per_second()},
          {"steps_per_search", r.steps_per_search},
          {"bytes_per_particle", r.bytes_per_particle},
          {"stage_shares", stages}};
}

void print_json(nlohmann::ordered_json json) {
  json["smelt"] = version;
  fmt::print("{}\n", json.dump(2));
}

}  // namespace

void print_step_bench(std::size_t n_particles, bool as_json) {
  const StepBenchResult r = bench_step(n_particles);
  if (as_json) return print_json({{"step", to_json(r)}});
  fmt::print("{:.2f} million particle-steps/s\n", r.particle_steps_per_second() / 1e6);
  fmt::print(
      "{} particles, {:.1f} neighbours, {:.4g} ms a step, {:.1f} steps between searches, {:.0f} bytes a particle\n",
      r.n_particles, r.neighbours, 1e3 * r.seconds_per_step, r.steps_per_search, r.bytes_per_particle);
  std::string stages;
  for (std::size_t k = 0; k < step_stage_names.size(); ++k)
    stages += fmt::format("{}{} {:.1f} %", k == 0 ? "" : ", ", step_stage_names[k], 100.0 * r.stage_shares[k]);
  fmt::print("{}\n", stages);
}

void print_terms_bench(std::size_t n_particles, bool as_json) {
  struct Case {
    const char* name;
    StepBenchTerms terms;
  };
  const Case cases[] = {{"Newtonian", {.viscoplastic = false, .heat = false, .walls = false}},
                        {"SMD", {.viscoplastic = true, .heat = false, .walls = false}},
                        {"SMD + heat", {.viscoplastic = true, .heat = true, .walls = false}},
                        {"SMD + heat + walls", {.viscoplastic = true, .heat = true, .walls = true}}};
  nlohmann::ordered_json all;
  if (!as_json)
    fmt::print("| scene | bytes a particle | seconds a step | million particle-steps/s |\n|---|---|---|---|\n");
  for (const Case& c : cases) {
    const StepBenchResult r = bench_step(n_particles, c.terms);
    if (as_json)
      all["terms"][c.name] = to_json(r);
    else
      fmt::print("| {} | {:.0f} | {:.4f} | {:.2f} |\n", c.name, r.bytes_per_particle, r.seconds_per_step,
                 r.particle_steps_per_second() / 1e6);
  }
  if (as_json) print_json(std::move(all));
}

void print_thesis_bench(const std::string& only, bool as_json) {
  nlohmann::ordered_json all;
  if (!as_json)
    fmt::print(
        "| shot | particles | seconds a step | table 6.2: particles | seconds a step | times as fast |\n"
        "|---|---|---|---|---|---|\n");
  for (const ThesisShot& shot : thesis_shots()) {
    if (!only.empty() && shot.name != only) continue;
    const ThesisBenchResult r = bench_thesis_shot(shot);
    const double times_as_fast = shot.seconds_per_step / r.seconds_per_step;
    if (as_json)
      all["thesis"][shot.name] = {{"particles", r.n_particles},
                                  {"seconds_per_step", r.seconds_per_step},
                                  {"table_particles", shot.n_particles},
                                  {"table_seconds_per_step", shot.seconds_per_step},
                                  {"times_as_fast", times_as_fast}};
    else
      fmt::print("| {} | {} | {:.5f} | {} | {:.2f} | {:.0f} |\n", shot.name, r.n_particles, r.seconds_per_step,
                 shot.n_particles, shot.seconds_per_step, times_as_fast);
  }
  if (as_json) print_json(std::move(all));
}

void print_pairs_bench(std::size_t n_particles, bool as_json) {
  const PairsBench bench = bench_pairs(n_particles);
  const MachinePeaks& peaks = bench.peaks;
  if (as_json) {
    nlohmann::ordered_json json;
    json["peaks"] = {{"flops", peaks.flops},
                     {"l1_bytes", peaks.l1_bytes},
                     {"l2_bytes", peaks.l2_bytes},
                     {"l3_bytes", peaks.l3_bytes},
                     {"memory_bytes", peaks.memory_bytes}};
    for (const PassTiming& p : bench.passes)
      json["passes"].push_back({{"pass", p.pass},
                                {"instructions", p.instructions},
                                {"particles", p.n_particles},
                                {"pairs_per_second", p.pairs_per_second},
                                {"flops_per_pair", p.flops_per_pair},
                                {"bytes_per_pair", p.bytes_per_pair}});
    return print_json(std::move(json));
  }
  fmt::print(
      "one core: {:.0f} Gflop/s in single precision; reads {:.0f} GB/s from 24 KiB, {:.0f} from 384 KiB, {:.0f} from 6 "
      "MiB, {:.1f} from 256 MiB\n",
      1e-9 * peaks.flops, 1e-9 * peaks.l1_bytes, 1e-9 * peaks.l2_bytes, 1e-9 * peaks.l3_bytes,
      1e-9 * peaks.memory_bytes);
  fmt::print(
      "| pass | instructions | million pairs/s | flops a pair | Gflop/s | bytes a pair | GB/s | of the flops | of the "
      "second cache's bytes |\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|\n");
  for (const PassTiming& p : bench.passes)
    fmt::print("| {} | {} | {:.0f} | {:.0f} | {:.1f} | {:.0f} | {:.1f} | {:.0f} % | {:.0f} % |\n", p.pass,
               p.instructions, 1e-6 * p.pairs_per_second, p.flops_per_pair, 1e-9 * p.flops(), p.bytes_per_pair,
               1e-9 * p.bytes(), 100.0 * p.flops() / peaks.flops, 100.0 * p.bytes() / peaks.l2_bytes);
}

}  // namespace smelt
