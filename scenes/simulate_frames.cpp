#include "core/error.h"
#include "core/hash.h"
#include "io/atomic_file.h"
#include "io/body_poses.h"
#include "io/checkpoint.h"
#include "io/particles_vdb.h"
#include "scenes/build_simulation.h"
#include "scenes/rest_positions.h"
#include "scenes/scene_reader.h"
#include "scenes/scene_writer.h"
#include "scenes/solver_frame.h"
#include "scenes/stage_frames.h"
#include "scenes/stages.h"
#include "scenes/version.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace smelt {

namespace {

namespace fs = std::filesystem;

/// Newest first.
std::vector<std::filesystem::path> list_checkpoints(const OutputFolder& folder) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(folder.checkpoints()))
    for (const auto& entry : std::filesystem::directory_iterator(folder.checkpoints()))
      if (entry.path().extension() == ".bin") files.push_back(entry.path());
  std::sort(files.rbegin(), files.rend());
  return files;
}

std::optional<Checkpoint> read_if_sound(const std::filesystem::path& file, Progress& progress) {
  try {
    return read_checkpoint(file);
  } catch (const Error& error) {
    progress.message(fmt::format("{}; trying the one before", error.what()));
    return std::nullopt;
  }
}

bool has_files(const fs::path& folder) {
  return fs::is_directory(folder) && !fs::is_empty(folder);
}

/// Whether a run wrote this folder: by its report or a checkpoint. A scene.toml may be anybody's.
bool holds_result(const OutputFolder& folder, const RunReport& report) {
  return report.is_of_smelt() || !list_checkpoints(folder).empty();
}

/// What a run without checkpoints left, if that is more than the first frame, from which a run starts over anyway.
std::optional<fs::path> find_later_files(const OutputFolder& folder) {
  for (const fs::path& stage : {folder.surfaces(), folder.frames()})
    if (has_files(stage)) return stage;
  if (fs::is_directory(folder.particles()))
    for (const auto& entry : fs::directory_iterator(folder.particles()))
      if (entry.path().extension() == ".vdb" && entry.path() != folder.particles(1)) return entry.path();
  return std::nullopt;
}

/// The newest sound checkpoint; nothing where the folder has none and holds no frames but the first. Throws Error where
/// those it has are of no use, or missing: starting over would write over frames that somebody wanted to keep.
std::optional<Checkpoint> find_checkpoint(const OutputFolder& folder, const RunReport& report, std::uint64_t scene_hash,
                                          Progress& progress) {
  const auto files = list_checkpoints(folder);
  for (const auto& file : files) {
    std::optional<Checkpoint> checkpoint = read_if_sound(file, progress);
    if (!checkpoint) continue;
    if (checkpoint->scene_hash != scene_hash)
      fail(
          "{}: this folder was simulated from another scene or other meshes, or by another version of smelt; resume with {}, or use "
          "another folder (-o)",
          file.string(), folder.scene().string());
    return checkpoint;
  }
  if (!files.empty())
    fail(
        "{}: none of the checkpoints can be read, so there is nothing to resume from; without --resume the result is "
        "moved aside and the shot starts over",
        folder.checkpoints().string());
  if (const auto later = find_later_files(folder))
    fail(
        "{}: there are no checkpoints, so there is nothing to resume the simulation from, but {} is there; `smelt surface` and "
        "`smelt render` need none; without --resume the result is moved aside and the shot starts over",
        folder.checkpoints().string(), later->string());
  if (const auto hash = report.simulation_hash(); hash && *hash != scene_hash)
    fail(
        "{}: this folder was simulated from another scene or other meshes, or by another version of smelt, and has no "
        "checkpoints; use another folder (-o), or start over without --resume",
        folder.report().string());
  return std::nullopt;
}

// ------------------------------------------------------------------------------------------------------ earlier result

bool is_below(const fs::path& path, const fs::path& folder) {
  const fs::path inner = fs::weakly_canonical(fs::absolute(path)), outer = fs::weakly_canonical(folder);
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

/// Throws Error where a run would write over what no run wrote or, from the start, would move away what the user works
/// in or the scene is made of.
void check_folder(const Scene& scene, const OutputFolder& folder, bool resume) {
  const RunReport report(folder.report(), true);
  if (!holds_result(folder, report)) {
    for (const fs::path& theirs : {folder.scene(), folder.particles()})
      if (fs::is_directory(theirs) ? has_files(theirs) : fs::exists(theirs))
        fail("{}: is in the way and no run of smelt wrote it, as there is no {}; use another folder (-o)",
             theirs.string(), folder.report().string());
    return;
  }
  if (resume) return;
  const auto refuse = [&](const fs::path& path, const char* what) {
    if (is_below(path, folder.root))
      fail("{}: holds an earlier result and would be moved aside, but {} in it ({}); use another folder (-o)",
           folder.root.string(), what, path.string());
  };
  refuse(fs::current_path(), "you are");
  if (!scene.file.empty()) refuse(scene.file, "the scene is");
  for (const BodySettings& b : scene.bodies) refuse(find_mesh(scene, b.mesh), "a body's mesh is");
  for (const ColliderSettings& c : scene.colliders)
    if (c.mesh != "ground") refuse(find_mesh(scene, c.mesh), "a collider's mesh is");
}

/// Nothing computed is ever lost: an earlier result gives way to a new one by taking another name.
void move_aside(const OutputFolder& folder, Progress& progress) {
  if (!holds_result(folder, RunReport(folder.report(), true))) return;
  for (int k = 1;; ++k) {
    fs::path aside = folder.root;
    aside += fmt::format(".{}", k);
    if (fs::exists(aside)) continue;
    std::error_code error;
    fs::rename(folder.root, aside, error);
    if (error)
      fail("{}: cannot move the earlier result aside: {}; use another folder (-o) or --resume", folder.root.string(),
           error.message());
    progress.message(fmt::format("moved the earlier result to {} (--resume goes on from it instead)", aside.string()));
    return;
  }
}

/// The folders, the scene as run, and the head of the report: it goes first, as it tells a result from other files.
void open_folder(const Scene& scene, const OutputFolder& folder, const SimulationSetup& setup, std::uint64_t scene_hash,
                 RunReport& report) {
  create_directories_or_fail(folder.particles());
  create_directories_or_fail(folder.checkpoints());
  const std::string text = write_scene(scene);
  report.set_run(text, scene_hash, setup.spacing, setup.body_volume);
  write_file_atomically(folder.scene(), text);
}

// ---------------------------------------------------------------------------------------------------------- simulation

/// Advances from one frame to the next.
template <typename Real>
StepStatistics advance_frame(Solver<3, Real>& solver, double start_time, double interval, ProgressState state,
                             Progress& progress) {
  StepStatistics statistics;
  solver.prepare(start_time);
  for (double remaining = interval; remaining > 0.0;) {
    const TimeStep step = solver.step(remaining, start_time + interval - remaining);
    remaining -= step.dt;
    statistics.add(step);
    state.fraction = 1.0 - remaining / interval;
    state.details = fmt::format("step {} dt {:.2e} s ({})", statistics.n_steps, step.dt,
                                time_step_term_names[static_cast<std::size_t>(step.term)]);
    progress.update(state);
    stop_if_asked(progress, "simulate", state.frame);
  }
  return statistics;
}

std::vector<BodyPose> to_body_poses(const Colliders<3>& colliders) {
  std::vector<BodyPose> poses;
  for (std::size_t k = 0; k < colliders.placed().size(); ++k)
    if (const auto& body = colliders.placed()[k].body)
      poses.push_back(
          {static_cast<int>(k), body->pose(), body->state.centre, body->state.velocity, from_skew(body->spin())});
  return poses;
}

/// Writes the frame and returns its files.
template <typename Real>
std::vector<fs::path> store_frame(const Solver<3, Real>& solver, const SimulationSetup& setup,
                                  const OutputFolder& folder, int frame, double time,
                                  std::optional<RestPositions>& rest) {
  ParticleFrame cache = to_frame(solver, setup.spacing, frame, time);
  if (rest) rest->set_rest(cache);
  write_particles(folder.particles(frame), cache);
  const std::vector<BodyPose> bodies = to_body_poses(solver.colliders());
  if (bodies.empty()) return {folder.particles(frame)};
  write_body_poses(folder.bodies(frame), frame, time, bodies);
  return {folder.particles(frame), folder.bodies(frame)};
}

/// After the cache and the report: a checkpoint says that all of its frame is safe.
template <typename Real>
void store_checkpoint(const Solver<3, Real>& solver, const OutputFolder& folder, std::uint64_t scene_hash, int frame,
                      double time) {
  write_checkpoint(folder.checkpoint(frame),
                   {frame, time, scene_hash, solver.particles(), solver.account(), solver.colliders().body_states()});
  std::filesystem::remove(folder.checkpoint(frame - 2));
}

template <typename Real>
std::optional<HeatLedger> ledger_of(const Solver<3, Real>& solver) {
  if (!solver.knows_enthalpy()) return std::nullopt;
  return solver.heat_ledger();
}

template <typename Real>
void run_simulation(const Scene& scene, const OutputFolder& folder, const StageOptions& options, SimulationSetup& setup,
                    const std::optional<Checkpoint>& checkpoint, std::uint64_t scene_hash, RunReport& report,
                    Progress& progress) {
  Colliders<3> colliders = build_colliders(setup);
  if (checkpoint) colliders.set_body_states(checkpoint->bodies);
  Solver<3, Real> solver(setup.parameters, setup.materials, std::move(colliders),
                         checkpoint ? checkpoint->particles : std::move(setup.particles),
                         checkpoint ? checkpoint->account : ParticleAccount{});
  // From here on nothing is refused any more.
  if (!options.resume) move_aside(folder, progress);
  open_folder(scene, folder, setup, scene_hash, report);
  if (solver.colliders().has_bodies()) create_directories_or_fail(folder.bodies());
  std::optional<RestPositions> rest;
  if (scene.particles.rest_position) rest.emplace(setup.parameters);
  int frame = 1;
  if (checkpoint) {
    frame = checkpoint->frame;
    if (rest) rest->take_over(read_particles(folder.particles(frame)));
    progress.message(fmt::format("resuming after frame {}", frame));
  } else {
    const CostMeter meter;
    const auto files = store_frame(solver, setup, folder, 1, 0.0, rest);
    const Diagnostics<3> diagnostics = compute_diagnostics(solver);
    report.set_simulated(1, 0.0, {}, diagnostics, compute_mass_account(solver, diagnostics.mass), ledger_of(solver),
                         to_body_poses(solver.colliders()), meter.finish(files));
    store_checkpoint(solver, folder, scene_hash, 1, 0.0);
  }

  while (frame < options.frames.last) {
    const CostMeter meter;
    const double start_time = (frame - 1) / scene.shot.fps;
    ++frame;
    const ProgressState state{"simulate", frame, 1, options.frames.last, 0.0, ""};
    StepStatistics statistics;
    try {
      statistics = advance_frame(solver, start_time, 1.0 / scene.shot.fps, state, progress);
    } catch (const DivergedError& error) {
      throw DivergedError(
          fmt::format("{}; frames 1 to {} are kept in {}", error.what(), frame - 1, folder.particles().string()));
    }
    const double time = (frame - 1) / scene.shot.fps;
    const auto files = store_frame(solver, setup, folder, frame, time, rest);
    const Diagnostics<3> diagnostics = compute_diagnostics(solver);
    report.set_simulated(frame, time, statistics, diagnostics, compute_mass_account(solver, diagnostics.mass),
                         ledger_of(solver), to_body_poses(solver.colliders()), meter.finish(files));
    store_checkpoint(solver, folder, scene_hash, frame, time);
  }
}

std::uint64_t hash_mesh(const TriangleMesh& mesh, std::uint64_t seed) {
  const auto bytes = [](const auto& values) {
    return std::string_view(reinterpret_cast<const char*>(values.data()), values.size() * sizeof values[0]);
  };
  return hash_bytes(bytes(mesh.triangles), hash_bytes(bytes(mesh.vertices), seed));
}

/// Of all that the particles depend on: the settings, the meshes that they name, wherever their bytes come from, and
/// what follows from the length of the shot. How colliders look is left out.
std::uint64_t hash_simulation(const Scene& scene, const SimulationSetup& setup) {
  Scene bare = scene;
  for (ColliderSettings& c : bare.colliders) {
    const ColliderSettings plain;
    c.colour = plain.colour;
    c.material = plain.material;
    c.roughness = plain.roughness;
  }
  std::uint64_t hash = hash_bytes(version, hash_bytes(write_section(bare, SceneSection::simulation)));
  for (const TriangleMesh& mesh : import_placed_bodies(scene)) hash = hash_mesh(mesh, hash);
  for (const TriangleMesh& mesh : setup.colliders) hash = hash_mesh(mesh, hash);
  return hash_bytes(fmt::format("{} {}", setup.parameters.sound_speed, setup.parameters.shear_wave_speed), hash);
}

}  // namespace

void simulate_frames(const Scene& scene, const OutputFolder& folder, const StageOptions& options, RunReport& report,
                     Progress& progress) {
  check_folder(scene, folder, options.resume);
  SimulationSetup setup = build_simulation(scene);
  for (const std::string& warning : setup.warnings) progress.message("warning: " + warning);
  const std::uint64_t scene_hash = hash_simulation(scene, setup);
  const auto checkpoint = options.resume ? find_checkpoint(folder, report, scene_hash, progress) : std::nullopt;
  if (scene.solver.precision == "double")
    run_simulation<double>(scene, folder, options, setup, checkpoint, scene_hash, report, progress);
  else
    run_simulation<float>(scene, folder, options, setup, checkpoint, scene_hash, report, progress);
}

}  // namespace smelt
