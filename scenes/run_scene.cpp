#include "scenes/run_scene.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "scenes/failed_frames.h"
#include "scenes/film.h"

#include <charconv>
#include <chrono>
#include <functional>
#include <optional>

namespace smelt {

namespace {

OutputFolder output_folder(const Scene& scene, const RunOptions& options) {
  const std::filesystem::path folder =
      options.folder.empty() ? std::filesystem::path("out") / scene.shot.name : options.folder;
  const std::filesystem::path root = std::filesystem::absolute(folder).lexically_normal();
  return {root.has_filename() ? root : root.parent_path()};  // "out/", as a shell completes it, is "out"
}

double timed(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The pictures asked for: the scene's own or diagnostic ones; for a sheet only those on it.
void draw_pictures(const Scene& scene, const OutputFolder& folder, const StageOptions& options,
                   const PictureRequest& request, RunReport& report, Progress& progress) {
  if (request.diagnostic) return diagnose_frames(scene, folder, options.frames, request, progress);
  if (request.sheet_columns == 0) return render_frames(scene, folder, options, report, progress);
  for (const int frame : choose_sheet_frames(options.frames, request.sheet_columns * request.sheet_rows))
    render_frames(scene, folder, {{frame, frame}, options.resume}, report, progress);
}

}  // namespace

FrameRange parse_frame_range(const std::string& text, int last) {
  const auto number = [&](std::string_view part, int fallback) {
    if (part.empty()) return fallback;
    int value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size())
      fail("--frames {}: must be A-B, A- or a single frame, counted from 1", text);
    return value;
  };
  const std::size_t dash = text.find('-');
  const std::string_view whole = text;
  FrameRange range;
  range.first = number(whole.substr(0, dash), 1);
  range.last = dash == std::string::npos ? range.first : number(whole.substr(dash + 1), last);
  if (text.empty() || range.first < 1 || range.last > last || range.first > range.last)
    fail("--frames {}: must lie within 1-{}, first frame first", text, last);
  return range;
}

RunSummary run_scene(const Scene& scene, const RunOptions& options, Progress& progress) {
  RunSummary summary{output_folder(scene, options), options.frames.value_or(FrameRange{1, scene.shot.frames})};
  const OutputFolder& folder = summary.folder;
  RunReport report(folder.report(), options.resume);
  const StageOptions stage{summary.frames, options.resume};
  summary.simulate_seconds = timed([&] { simulate_frames(scene, folder, stage, report, progress); });
  // What has a surface is drawn before a surface that failed ends the run.
  std::optional<FramesFailed> failed;
  const auto attempt = [&](auto frames_of_stage) {
    return timed([&] {
      try {
        frames_of_stage(scene, folder, stage, report, progress);
      } catch (const FramesFailed& error) {
        if (!failed) failed = error;
      }
    });
  };
  summary.surface_seconds = attempt(surface_frames);
  summary.render_seconds = attempt(render_frames);
  if (failed) throw FramesFailed(*failed);
  if (summary.frames.last == scene.shot.frames) {
    std::string why_not;
    summary.film = encode_film(folder, scene.shot.name, scene.shot.frames, scene.shot.fps, why_not);
    if (!summary.film) progress.message("no film: " + why_not);
  }
  return summary;
}

RunSummary run_stage(const Scene& scene, Stage stage, const RunOptions& options, Progress& progress) {
  RunSummary summary{output_folder(scene, options), options.frames.value_or(FrameRange{1, scene.shot.frames})};
  const OutputFolder& folder = summary.folder;
  if (stage != Stage::simulate) create_directories_or_fail(folder.root);
  RunReport report(folder.report(), stage != Stage::simulate || options.resume);
  const StageOptions how{summary.frames, options.resume};
  switch (stage) {
    case Stage::simulate:
      summary.simulate_seconds = timed([&] { simulate_frames(scene, folder, how, report, progress); });
      break;
    case Stage::surface:
      summary.surface_seconds = timed([&] { surface_frames(scene, folder, how, report, progress); });
      break;
    case Stage::render:
      summary.render_seconds = timed([&] { draw_pictures(scene, folder, how, options.pictures, report, progress); });
      if (options.pictures.sheet_columns > 0) summary.sheet = write_sheet(folder, summary.frames, options.pictures);
      break;
  }
  return summary;
}

}  // namespace smelt
