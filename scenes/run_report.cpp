#include "scenes/run_report.h"

#include "core/hash.h"
#include "io/atomic_file.h"
#include "io/vector_json.h"
#include "scenes/machine.h"
#include "scenes/version.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <thread>

namespace smelt {

using nlohmann::ordered_json;

struct RunReport::Document {
  ordered_json root;

  ordered_json& frame(int number) {
    auto& frames = root["frames"];
    if (!frames.is_array()) frames = ordered_json::array();
    while (frames.size() < static_cast<std::size_t>(number)) frames.push_back({{"frame", frames.size() + 1}});
    return frames[static_cast<std::size_t>(number) - 1];
  }
};

namespace {

ordered_json cost_json(const StageCost& cost) {
  return {{"seconds", cost.seconds}, {"bytes", cost.bytes}};
}

ordered_json heat_json(double enthalpy, const HeatLedger& passed) {
  return {{"enthalpy_J", enthalpy},
          {"since_last_frame_J",
           {{"radiated", passed.radiated},
            {"convected", passed.convected},
            {"to_walls", passed.to_walls},
            {"from_sources", passed.from_sources}}}};
}

}  // namespace

void StepStatistics::add(const TimeStep& step) {
  min_dt = n_steps == 0 ? step.dt : std::min(min_dt, step.dt);
  max_dt = std::max(max_dt, step.dt);
  total_dt += step.dt;
  ++n_steps;
  ++n_by_term[static_cast<std::size_t>(step.term)];
}

RunReport::RunReport(std::filesystem::path path, bool keep)
    : path_(std::move(path)), document_(std::make_unique<Document>()), shared_(keep) {
  if (!keep || !std::filesystem::exists(path_)) return;
  ordered_json old = ordered_json::parse(read_file(path_), nullptr, /*allow_exceptions=*/false);
  if (old.is_object()) document_->root = std::move(old);
}

RunReport::~RunReport() = default;

void RunReport::set_run(const std::string& scene_text, std::uint64_t scene_hash, double spacing, double body_volume) {
  ordered_json& root = document_->root;
  root["smelt"] = version;
  root["scene_hash"] = fmt::format("{:016x}", hash_bytes(scene_text));
  root["simulation_hash"] = fmt::format("{:016x}", scene_hash);
  root["machine"] = {{"cpu", cpu_name()}, {"threads", std::thread::hardware_concurrency()}};
  root["particle_spacing_m"] = spacing;
  root["body_volume_m3"] = body_volume;
  if (!root.contains("frames")) root["frames"] = ordered_json::array();
  save();
}

void RunReport::set_simulated(int frame, double time, const StepStatistics& steps, const Diagnostics<3>& d,
                              const std::optional<MassAccount>& mass, const std::optional<HeatLedger>& heat,
                              const std::vector<BodyPose>& bodies, const StageCost& cost) {
  ordered_json terms = ordered_json::object();
  for (std::size_t k = 0; k < n_time_step_terms; ++k) terms[std::string(time_step_term_names[k])] = steps.n_by_term[k];
  ordered_json entry = {{"time_s", time},
                        {"particles", d.n_particles},
                        {"steps", steps.n_steps},
                        {"dt_s",
                         {{"min", steps.min_dt},
                          {"mean", steps.n_steps ? steps.total_dt / steps.n_steps : 0.0},
                          {"max", steps.max_dt},
                          {"set_by", terms}}},
                        {"mass_kg", d.mass},
                        {"momentum_kg_m_s", vector_json(d.momentum)},
                        {"kinetic_energy_J", d.kinetic_energy},
                        {"potential_energy_J", d.potential_energy},
                        {"energy_J", d.kinetic_energy + d.potential_energy},
                        {"max_speed_m_s", d.max_speed},
                        {"density_error", {{"mean", d.mean_density_error}, {"max", d.max_density_error}}}};
  if (mass)
    entry["mass_account_kg"] = {{"initial", mass->initial},
                                {"added", mass->added},
                                {"removed", mass->removed},
                                {"present", mass->present},
                                {"imbalance", mass->initial + mass->added - mass->removed - mass->present}};
  if (mass) entry["poured_m3"] = mass->poured_volume;
  if (d.max_temperature > 0.0) entry["temperature_K"] = {{"min", d.min_temperature}, {"max", d.max_temperature}};
  for (const BodyPose& body : bodies)
    entry["bodies"].push_back({{"collider", body.collider},
                               {"centre_m", vector_json(body.centre)},
                               {"velocity_m_s", vector_json(body.velocity)},
                               {"angular_velocity_rad_s", vector_json(body.angular_velocity)}});
  if (heat) entry["heat"] = heat_json(d.enthalpy, *heat);
  entry.update(cost_json(cost));
  document_->frame(frame)["simulate"] = entry;
  set(frame, "simulate");
}

void RunReport::set_surfaced(int frame, double volume, std::size_t n_vertices, std::size_t n_triangles,
                             const StageCost& cost, std::uint64_t settings) {
  ordered_json entry = {{"volume_m3", volume}, {"vertices", n_vertices}, {"triangles", n_triangles}};
  entry.update(cost_json(cost));
  entry["settings"] = fmt::format("{:016x}", settings);
  document_->frame(frame)["surface"] = entry;
  set(frame, "surface");
}

void RunReport::set_rendered(int frame, double clamped_share, const StageCost& cost, std::uint64_t settings) {
  ordered_json entry = cost_json(cost);
  entry["clamped_share"] = clamped_share;
  entry["settings"] = fmt::format("{:016x}", settings);
  document_->frame(frame)["render"] = entry;
  set(frame, "render");
}

std::optional<std::uint64_t> RunReport::settings_of(int frame, const std::string& stage) const {
  const ordered_json& root = document_->root;
  const auto k = static_cast<std::size_t>(frame) - 1;
  if (!root.contains("frames") || k >= root["frames"].size()) return std::nullopt;
  const ordered_json& entry = root["frames"][k];
  if (!entry.contains(stage) || !entry[stage].contains("settings")) return std::nullopt;
  return std::stoull(entry[stage]["settings"].get<std::string>(), nullptr, 16);
}

bool RunReport::is_of_smelt() const {
  const ordered_json& root = document_->root;
  return root.is_object() && (root.contains("smelt") || root.contains("frames"));
}

std::optional<std::uint64_t> RunReport::simulation_hash() const {
  const ordered_json& root = document_->root;
  if (!root.is_object() || !root.contains("simulation_hash")) return std::nullopt;
  return std::stoull(root["simulation_hash"].get<std::string>(), nullptr, 16);
}

void RunReport::begin(int frame, const std::string& stage) {
  if (settings_of(frame, stage) && document_->frame(frame).erase(stage) > 0) set(frame, stage);
}

void RunReport::set(int frame, const std::string& stage) {
  ours_.emplace(frame, stage);
  save();
}

void RunReport::save() {
  const FolderLock lock(path_.parent_path());
  if (shared_ && std::filesystem::exists(path_)) {
    ordered_json theirs = ordered_json::parse(read_file(path_), nullptr, /*allow_exceptions=*/false);
    if (theirs.is_object() && theirs.contains("frames")) {
      Document merged{std::move(theirs)};
      for (const auto& [frame, stage] : ours_) {
        const ordered_json& mine = document_->frame(frame);
        merged.frame(frame).erase(stage);
        if (mine.contains(stage)) merged.frame(frame)[stage] = mine[stage];
      }
      document_->root["frames"] = std::move(merged.root["frames"]);
    }
  }
  shared_ = true;
  write_file_atomically(path_, document_->root.dump(1) + "\n");
}

}  // namespace smelt
