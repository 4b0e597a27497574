#include "cli/commands.h"

#include "bench/thesis_bench.h"
#include "cli/bench_commands.h"
#include "cli/report_command.h"
#include "cli/terminal_progress.h"
#include "core/error.h"
#include "scenes/check_scene.h"
#include "scenes/describe_file.h"
#include "scenes/machine_pace.h"
#include "scenes/run_scene.h"
#include "scenes/scene_reader.h"
#include "scenes/scene_writer.h"
#include "scenes/surface_series.h"
#include "scenes/version.h"

#include <CLI/CLI.hpp>
#include <tbb/global_control.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <functional>
#include <memory>
#include <sstream>
#include <system_error>
#include <tuple>
#include <unistd.h>

namespace smelt {

namespace {

/// Options that commands on a scene share.
struct SceneOptions {
  std::string scene;
  std::string folder;
  std::string frames;
  std::vector<std::string> overrides;
  int threads = 0;
  bool resume = false;
  std::string look = "beauty";
  std::string colour_by;
  std::string colour_range;
  std::string overlay;
  std::string sheet;
};

/// oneTBB, and Embree through it, use this many threads while the object lives.
std::unique_ptr<tbb::global_control> limit_threads(int threads) {
  if (threads <= 0) return nullptr;
  return std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                               static_cast<std::size_t>(threads));
}

void print_summary(const RunSummary& s) {
  fmt::print("folder    {}\nframes    {}-{}\n", s.folder.root.string(), s.frames.first, s.frames.last);
  const auto stage = [](const char* name, double seconds) {
    if (seconds > 0.0) fmt::print("{:<9} {:.1f} s\n", name, seconds);
  };
  stage("simulate", s.simulate_seconds);
  stage("surface", s.surface_seconds);
  stage("render", s.render_seconds);
  if (s.sheet) fmt::print("sheet     {}\n", s.sheet->string());
  if (s.film) fmt::print("film      {}\n", s.film->string());
}

/// Reads "A<separator>B", both numbers of type T.
template <typename T>
std::pair<T, T> parse_pair(const char* option, const std::string& text, char separator, const char* form) {
  const std::size_t at = text.find(separator, 1);
  std::pair<T, T> value{};
  const auto read = [](std::string_view part, T& number) {
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), number);
    return error == std::errc() && end == part.data() + part.size();
  };
  const std::string_view whole = text;
  if (at == std::string::npos || !read(whole.substr(0, at), value.first) || !read(whole.substr(at + 1), value.second))
    fail("{} {}: must be {}", option, text, form);
  return value;
}

PictureRequest to_request(const SceneOptions& o) {
  PictureRequest request;
  request.diagnostic = o.look == "diagnostic";
  if (request.diagnostic && o.resume)
    fail(
        "--resume does not go with --look diagnostic: the colours of a picture depend on the other frames, so all are "
        "drawn; leave it out");
  for (const auto& [given, option] :
       {std::pair{!o.colour_by.empty(), "--colour-by"}, std::pair{!o.colour_range.empty(), "--colour-range"},
        std::pair{!o.overlay.empty(), "--surface"}})
    if (given && !request.diagnostic) fail("{} goes with --look diagnostic alone", option);
  if (!o.colour_by.empty()) request.colour_by = o.colour_by;
  if (!o.overlay.empty()) request.overlay = o.overlay;
  if (!o.colour_range.empty()) {
    request.range = parse_pair<double>("--colour-range", o.colour_range, ':', "LOW:HIGH, two numbers");
    if (!(request.range->first < request.range->second))
      fail("--colour-range {}: LOW must be below HIGH", o.colour_range);
  }
  if (!o.sheet.empty()) {
    std::tie(request.sheet_columns, request.sheet_rows) =
        parse_pair<int>("--sheet", o.sheet, 'x', "COLUMNSxROWS, such as 4x3");
    if (request.sheet_columns < 1 || request.sheet_rows < 1 || request.sheet_columns > 32 || request.sheet_rows > 64)
      fail("--sheet {}: must be 1x1 to 32x64", o.sheet);
  }
  return request;
}

void run_on_scene(const SceneOptions& o,
                  const std::function<RunSummary(const Scene&, const RunOptions&, Progress&)>& work) {
  const Scene scene = read_scene(o.scene, o.overrides);
  const auto threads = limit_threads(o.threads);
  RunOptions options{o.folder, std::nullopt, o.resume, to_request(o)};
  if (!o.frames.empty()) options.frames = parse_frame_range(o.frames, scene.shot.frames);
  RunSummary summary;
  {
    TerminalProgress progress;
    summary = work(scene, options, progress);
  }
  print_summary(summary);
}

void print_check(const SceneOptions& o) {
  const Scene scene = read_scene(o.scene, o.overrides);
  const auto threads = limit_threads(o.threads);
  const SceneForecast f = forecast_scene(scene);
  for (const std::string& warning : f.warnings) print_to_stderr(fmt::format("smelt: warning: {}\n", warning));
  fmt::print(
      "scene       {}: {} frames at {} fps\nparticles   {}{}, {:.4g} m apart\nvolume      {:.6g} m3\nsound speed "
      "{:.4g} m/s\ntime step   {:.3g} s, set by the {} term\nsteps       {:.0f} at that time step\nmemory      {:.1f} "
      "MB for the simulation\ntime        {:.0f} s for the simulation, {:.0f} s for the surfaces, {:.0f} s for the "
      "pictures, {}\n",
      scene.shot.name, scene.shot.frames, scene.shot.fps, f.n_particles,
      f.n_particles_end == f.n_particles ? "" : fmt::format(" at the start, {} at the end", f.n_particles_end),
      f.spacing, f.body_volume, f.sound_speed, f.time_step, f.time_step_term, f.n_steps, f.bytes / 1e6,
      f.simulate_seconds, f.surface_seconds, f.render_seconds,
      f.load
          ? fmt::format("when this machine is idle; now {:.1f} times that", *f.load)
          : std::string(
                "at this machine's pace now (`./smelt bench --calibrate` on an idle machine makes this independent of "
                "what else runs)"));
  for (const std::string& advice : f.advice) fmt::print("advice      {}\n", advice);
}

/// `smelt surface` on particle files.
struct SeriesArguments {
  std::vector<std::string> names;
  std::optional<double> spacing;
  std::optional<std::vector<std::string>> attributes;
};

void print_series(const SeriesArguments& a, const SceneOptions& o) {
  const auto threads = limit_threads(o.threads);
  SeriesOptions options{o.folder, o.resume, o.overrides, a.spacing, a.attributes};
  if (o.folder.empty())
    options.folder = std::filesystem::path("out") / std::filesystem::path(a.names.front()).stem().stem();
  SeriesSummary s;
  {
    TerminalProgress progress;
    s = surface_series(a.names, o.frames, options, progress);
  }
  fmt::print("folder    {}\nframes    {} made, {} kept\nspacing   {:.6g} m, {}\n", s.folder.string(), s.n_made,
             s.n_kept, s.spacing,
             s.spacing_is_estimated ? "estimated"
             : a.spacing            ? "as given"
                                    : "from the files");
}

bool is_scene(const std::vector<std::string>& names) {
  return names.size() == 1 && std::filesystem::path(names.front()).extension() == ".toml";
}

/// The option table.
void add_common_options(CLI::App& command, SceneOptions& o, bool makes_frames) {
  command.add_option("--set", o.overrides, "set a key of the scene: key.path=value, any number of times")
      ->take_all()
      ->allow_extra_args(false);
  command.add_option("--threads", o.threads, "threads to use; by default all")->check(CLI::Range(1, 4096));
  if (!makes_frames) return;
  command.add_option("-o,--output", o.folder, "folder for the results; by default out/<name of the shot>");
  command.add_option("--frames", o.frames, "frames to make: A-B, A- or A");
  command.add_flag("--resume", o.resume, "go on from what an earlier run left in the folder");
}

struct BenchOptions {
  std::size_t n_particles = 100000;
  std::string shot;
  int threads = 0;
  bool json = false;
  bool calibrate = false;
};

void add_bench(CLI::App& app, BenchOptions& o, std::function<void()>& work) {
  CLI::App* bench = app.add_subcommand("bench", "how fast this machine is");
  bench->require_subcommand(0, 1);
  bench->add_flag("--calibrate", o.calibrate, "remember how fast it is while nothing else runs, for `smelt check`");
  bench->callback([&o, &work, bench] {
    if (o.calibrate && !bench->get_subcommands().empty())
      throw CLI::ExcludesError("--calibrate", bench->get_subcommands().front()->get_name());
    if (o.calibrate)
      work = [] { fmt::print("{:.4g} s for the fixed work, kept in {}\n", calibrate_pace(), pace_file().string()); };
    else if (bench->get_subcommands().empty())
      throw CLI::RequiredError("bench: --calibrate or a subcommand");
  });
  const auto add = [&](const char* name, const char* what, std::function<void()> print) {
    CLI::App* command = bench->add_subcommand(name, what);
    command->add_option("--threads", o.threads, "threads to use; by default all")->check(CLI::Range(1, 4096));
    command->add_flag("--json", o.json, "for machines");
    command->callback([&o, &work, print] {
      work = [&o, print] {
        const auto threads = limit_threads(o.threads);
        print();
      };
    });
    return command;
  };
  for (CLI::App* command :
       {add("step", "particle-steps a second of a full melting step",
            [&o] { print_step_bench(o.n_particles, o.json); }),
        add("terms", "what each term of a scene costs", [&o] { print_terms_bench(o.n_particles, o.json); }),
        add("pairs", "the pair loops on one core, beside what it can do at best",
            [&o] { print_pairs_bench(o.n_particles, o.json); })})
    command->add_option("--particles", o.n_particles, "about how many; 100000 unless said")
        ->check(CLI::Range(std::size_t{100}, std::size_t{100000000}));
  std::vector<std::string> shots;
  for (const ThesisShot& shot : thesis_shots()) shots.push_back(shot.name);
  add("thesis", "seconds per iteration of the shots of Paiva (2007), table 6.2, beside the table's",
      [&o] { print_thesis_bench(o.shot, o.json); })
      ->add_option("--shot", o.shot, "this one alone")
      ->check(CLI::IsMember(shots));
}

void add_picture_options(CLI::App& command, SceneOptions& o) {
  command.add_option("--look", o.look, "the scene's pictures, or particles as coloured spheres")
      ->check(CLI::IsMember({"beauty", "diagnostic"}));
  command.add_option("--colour-by", o.colour_by, "with --look diagnostic; by default temperature")
      ->check(CLI::IsMember({"temperature", "viscosity", "density", "speed", "pressure"}));
  command.add_option("--colour-range", o.colour_range, "LOW:HIGH of the colours; by default what the frames hold");
  command.add_option("--surface", o.overlay, "with --look diagnostic, over the particles")
      ->check(CLI::IsMember({"none", "wire", "translucent"}));
  command.add_option("--sheet", o.sheet, "COLUMNSxROWS: a contact sheet of frames evenly spread over the range");
}

void add_scene_options(CLI::App& command, SceneOptions& o, bool makes_frames) {
  command.add_option("scene", o.scene, "scene file (.toml)")->required();
  add_common_options(command, o, makes_frames);
}

/// Where stdin, stdout or stderr is closed, a file opened later would take its place and get what is printed. The
/// stand-in cannot be written to, so that results which go nowhere are still an error.
void keep_standard_streams_apart() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(fd, F_GETFD) == -1 && errno == EBADF && open("/dev/null", O_RDONLY) != fd)
      throw Error(fmt::format("file descriptor {} is closed, and /dev/null cannot be opened in its place", fd));
}

/// Throws WriteError where not all that was printed arrived: a full disk, a closed pipe.
void check_stdout() {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
  throw WriteError(fmt::format("standard output: cannot be written: {}; send it elsewhere",
                               errno == 0 ? "an earlier write failed" : std::strerror(errno)));
}

int run_parsed(int argc, char** argv) {
  CLI::App app("smelt: melts, sags, oozes and flows meshes as viscoplastic fluids", "smelt");
  app.set_version_flag("--version", std::string(version));
  app.require_subcommand(1);
  SceneOptions o;
  std::string file;
  BenchOptions bench;
  ReportOptions report;
  std::function<void()> work;

  const auto add = [&](const char* name, const char* what, auto&& body) {
    CLI::App* command = app.add_subcommand(name, what);
    command->callback([&work, body] { work = body; });
    return command;
  };
  add_scene_options(*add("run", "simulate, surface and render a shot", [&] { run_on_scene(o, run_scene); }), o, true);
  const auto add_stage = [&](const char* name, const char* what, Stage stage) {
    auto* command = add(name, what, [&o, stage] {
      run_on_scene(o, [stage](const Scene& s, const RunOptions& r, Progress& p) { return run_stage(s, stage, r, p); });
    });
    add_scene_options(*command, o, true);
    if (stage == Stage::render) add_picture_options(*command, o);
  };
  add_stage("simulate", "particles only", Stage::simulate);
  SeriesArguments series;
  auto* surface = add("surface", "surfaces of the particles of a shot, or of any particle files", [&] {
    if (!is_scene(series.names)) return print_series(series, o);
    if (series.spacing || series.attributes)
      fail("--spacing_m and --attributes are for particle files; a scene's particles have theirs");
    o.scene = series.names.front();
    run_on_scene(o,
                 [](const Scene& s, const RunOptions& r, Progress& p) { return run_stage(s, Stage::surface, r, p); });
  });
  surface
      ->add_option("files", series.names,
                   "scene file (.toml), or particle files (.vdb .ply .xyz .csv): names, or one with # for digits, "
                   "cloud.####.ply")
      ->required();
  surface
      ->add_option("--spacing_m", series.spacing,
                   "distance between particles; by default the cache's own, or estimated")
      ->check(CLI::PositiveNumber);
  surface
      ->add_option("--attributes", series.attributes,
                   "to carry over: v, temperature, viscosity; by default all that are there")
      ->delimiter(',');
  add_common_options(*surface, o, true);
  add_stage("render", "pictures of the surfaces in the folder", Stage::render);
  add_scene_options(*add("check", "validate a scene and tell what it will take", [&] { print_check(o); }), o, false);
  add("info", "what a particle cache or cloud, checkpoint, surface or mesh holds",
      [&] { fmt::print("{}", describe_file(file)); })
      ->add_option("file", file, "the file")
      ->required();
  add_bench(app, bench, work);
  add_report(app, report, work);
  add("scene-reference", "print all keys of a scene file", [] { fmt::print("{}", write_scene_reference()); });

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream out, err;
    const bool help = app.exit(error, out, err) == 0;
    print_to_stderr(err.str());
    fmt::print("{}", out.str());
    check_stdout();
    if (!help) return exit_usage;
    return exit_done;
  }
  work();
  check_stdout();
  return exit_done;
}

}  // namespace

int run_command_line(int argc, char** argv) {
  const auto report = [](const char* kind, const std::exception& error, ExitCode code) {
    print_to_stderr(fmt::format("smelt: {}{}\n", kind, error.what()));
    return static_cast<int>(code);
  };
  try {
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma"))
      throw Error(
          "this machine's processor has no AVX2 and FMA instructions, which smelt needs (any x86 processor since about "
          "2014 has)");
    keep_standard_streams_apart();
    // A file past the system's limit and a closed pipe are errors of who writes, not the end of the program.
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
    return run_parsed(argc, argv);
  } catch (const DivergedError& error) {
    return report("", error, exit_diverged);
  } catch (const Interrupted& error) {
    return report("", error, exit_interrupted);
  } catch (const Error& error) {
    return report("error: ", error, exit_bad_input);
  } catch (const std::bad_alloc& error) {
    return report("error: out of memory; fewer particles or a coarser surface would do: ", error, exit_bad_input);
  } catch (const std::system_error& error) {
    if (std::ferror(stdout) == 0) return report("internal error (please report it): ", error, exit_internal);
    // Printing threw.
    return report("error: standard output: ", error, exit_bad_input);
  } catch (const std::exception& error) {
    return report("internal error (please report it): ", error, exit_internal);
  }
}

}  // namespace smelt
