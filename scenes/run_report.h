#pragma once
// run.json: what a run did, frame by frame and stage by stage.

#include "core/sph/diagnostics.h"
#include "core/sph/time_step.h"
#include "io/body_poses.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace smelt {

/// The steps between two frames.
struct StepStatistics {
  int n_steps = 0;
  double min_dt = 0.0, max_dt = 0.0, total_dt = 0.0;  ///< [s]
  std::array<int, n_time_step_terms> n_by_term{};     ///< how many steps each term set

  void add(const TimeStep& step);
};

/// What came in and went out since the start.
struct MassAccount {
  double initial = 0.0, added = 0.0, removed = 0.0, present = 0.0;  ///< [kg]
  double poured_volume = 0.0;                                       ///< [m^3]
};

template <typename Real>
std::optional<MassAccount> compute_mass_account(const Solver<3, Real>& solver, double present) {
  const ParticleAccount& account = solver.account();
  if (account.initial.empty()) return std::nullopt;
  const double volume = solver.parameters().particle_volume;
  MassAccount mass;
  mass.present = present;
  for (std::size_t m = 0; m < account.initial.size(); ++m) {
    const double each = volume * solver.materials()[m].density;
    mass.initial += each * static_cast<double>(account.initial[m]);
    mass.removed += each * static_cast<double>(account.removed[m]);
  }
  for (std::size_t e = 0; e < account.entered.size(); ++e) {
    const double poured = volume * static_cast<double>(account.entered[e]);
    mass.poured_volume += poured;
    mass.added += poured * solver.materials()[solver.parameters().emitters[e].material].density;
  }
  return mass;
}

/// What a stage cost for one frame.
struct StageCost {
  double seconds = 0.0;
  std::uintmax_t bytes = 0;  ///< written, checkpoints left out
};

/// Keeps run.json up to date: each set_... replaces that stage of that frame and saves, so that a killed run leaves a
/// true report. Several machines may surface or render frames in one folder: each keeps what the others wrote.
class RunReport {
 public:
  /// Goes on from an existing report where `keep` is set and there is a readable one.
  RunReport(std::filesystem::path path, bool keep);
  ~RunReport();

  /// The head of the report; saves, so that the folder is known for a result before its first frame.
  void set_run(const std::string& scene_text, std::uint64_t scene_hash, double spacing, double body_volume);
  /// `mass` is absent in a scene without emitters and outflow, `bodies` empty in one without rigid bodies. `heat`: what
  /// passed since the frame before; absent where no specific heat is known.
  void set_simulated(int frame, double time, const StepStatistics& steps, const Diagnostics<3>& diagnostics,
                     const std::optional<MassAccount>& mass, const std::optional<HeatLedger>& heat,
                     const std::vector<BodyPose>& bodies, const StageCost& cost);
  /// `settings`: a hash of what the files were made from (made_from).
  void set_surfaced(int frame, double volume, std::size_t n_vertices, std::size_t n_triangles, const StageCost& cost,
                    std::uint64_t settings);
  /// `clamped_share`: of the picture's light, what the firefly limit took away.
  void set_rendered(int frame, double clamped_share, const StageCost& cost, std::uint64_t settings);

  /// The hash of what a stage ("surface", "render") made the files of a frame from; nothing where it has not, or
  /// was cut off.
  std::optional<std::uint64_t> settings_of(int frame, const std::string& stage) const;

  /// Whether the report read was one: its frames or its head are there.
  bool is_of_smelt() const;

  /// Of the scene and meshes that the particles were made from, by set_run(); nothing where it never was called.
  std::optional<std::uint64_t> simulation_hash() const;

  /// Takes a stage's entry back before its files are made anew: if that is cut off, they are neither old nor new.
  void begin(int frame, const std::string& stage);

 private:
  struct Document;
  void set(int frame, const std::string& stage);
  void save();

  std::filesystem::path path_;
  std::unique_ptr<Document> document_;
  bool shared_;                                 ///< another machine may have written to the file
  std::set<std::pair<int, std::string>> ours_;  ///< stages of frames that this run made
};

}  // namespace smelt
