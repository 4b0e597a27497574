#include "scenes/surface_series.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/extension.h"
#include "io/particle_cloud.h"
#include "io/particles_vdb.h"
#include "scenes/scene_reader.h"
#include "scenes/scene_writer.h"
#include "scenes/stage_frames.h"
#include "scenes/surface_files.h"
#include "surfacing/estimate_spacing.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <string_view>

namespace smelt {

namespace {

namespace fs = std::filesystem;

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

/// The last run of digits in a stem, or none.
std::optional<int> frame_of(const std::string& stem) {
  const auto last = std::find_if(stem.rbegin(), stem.rend(), is_digit);
  const auto before = std::find_if_not(last, stem.rend(), is_digit);
  if (last == stem.rend() || last - before < -9) return std::nullopt;
  return std::stoi(std::string(before.base(), last.base()));
}

/// A name with a run of #, as what stands before and behind it.
struct Pattern {
  fs::path folder;
  std::string head, tail;
  std::size_t n_digits = 0;

  fs::path path(int frame) const { return folder / fmt::format("{}{:0{}}{}", head, frame, n_digits, tail); }
};

std::optional<Pattern> parse_pattern(const fs::path& name) {
  const std::string file = name.filename().string();
  const std::size_t first = file.find('#');
  if (first == std::string::npos) return std::nullopt;
  const std::size_t end = std::min(file.find_first_not_of('#', first), file.size());
  return Pattern{name.parent_path(), file.substr(0, first), file.substr(end), end - first};
}

/// Frames whose files are there.
std::vector<int> frames_there(const Pattern& pattern) {
  std::vector<int> frames;
  const fs::path folder = pattern.folder.empty() ? fs::path(".") : pattern.folder;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(pattern.head) || !name.ends_with(pattern.tail) ||
        name.size() < pattern.head.size() + pattern.tail.size())
      continue;
    const std::string digits =
        name.substr(pattern.head.size(), name.size() - pattern.head.size() - pattern.tail.size());
    if (digits.empty() || digits.size() > 9 || !std::all_of(digits.begin(), digits.end(), is_digit)) continue;
    if (const int frame = std::stoi(digits); pattern.path(frame).filename() == name) frames.push_back(frame);
  }
  if (error) fail("{}: cannot be listed: {}", folder.string(), error.message());
  std::sort(frames.begin(), frames.end());
  return frames;
}

std::vector<ParticleFile> find_pattern_files(const std::string& name, const Pattern& pattern,
                                             const std::string& range) {
  const std::vector<int> there = frames_there(pattern);
  if (there.empty()) fail("{}: there is no such file; # stands for the digits of the frame number", name);
  FrameRange frames{there.front(), there.back()};
  if (!range.empty())
    frames = parse_frame_range(range, range.ends_with('-') ? there.back() : std::numeric_limits<int>::max());
  std::vector<ParticleFile> files;
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    files.push_back({pattern.path(frame), frame});
    if (!std::binary_search(there.begin(), there.end(), frame))
      fail("{}: frame {} is missing; there are {} files from frame {} to {}", files.back().path.string(), frame,
           there.size(), there.front(), there.back());
  }
  return files;
}

// ----------------------------------------------------------------------------------------------------------- particles

void keep_attributes(ParticleFrame& frame, bool has_velocity, const std::vector<std::string>& wanted) {
  const std::map<std::string, bool> there = {
      {"v", has_velocity}, {"temperature", !frame.temperature.empty()}, {"viscosity", !frame.viscosity.empty()}};
  std::vector<std::string> names;
  for (const auto& [name, is_there] : there)
    if (is_there) names.push_back(name);
  for (const std::string& name : wanted)
    if (std::find(names.begin(), names.end(), name) == names.end())
      fail("there is no attribute `{}` to carry over; the particles have: {}", name,
           names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")));
  const auto drop = [&](const char* name) { return std::find(wanted.begin(), wanted.end(), name) == wanted.end(); };
  if (drop("v")) std::fill(frame.velocity.begin(), frame.velocity.end(), Vec3f::Zero());
  if (drop("temperature")) frame.temperature.clear();
  if (drop("viscosity")) frame.viscosity.clear();
}

/// A cloud as a frame; its spacing is set by the caller.
ParticleFrame to_frame(ParticleCloud cloud, int frame) {
  ParticleFrame out;
  out.frame = frame;
  out.velocity = std::move(cloud.velocity);
  out.velocity.resize(cloud.position.size(), Vec3f::Zero());
  out.density = std::move(cloud.density);
  out.density.resize(cloud.position.size(), 1000.0f);
  out.temperature = std::move(cloud.temperature);
  out.viscosity = std::move(cloud.viscosity);
  out.position = std::move(cloud.position);
  out.id.resize(out.position.size());
  std::iota(out.id.begin(), out.id.end(), 0);
  return out;
}

ParticleFrame read_frame(const ParticleFile& file, double spacing, const SeriesOptions& options) {
  bool has_velocity = true;
  ParticleFrame frame;
  if (is_particle_cloud(file.path)) {
    ParticleCloud cloud = read_particle_cloud(file.path);
    has_velocity = !cloud.velocity.empty();
    frame = to_frame(std::move(cloud), file.frame);
    frame.spacing = spacing;
    for (const float density : frame.density)
      frame.masses.push_back(static_cast<float>(static_cast<double>(density) * spacing * spacing * spacing));
    frame.mass = frame.masses.empty() ? 0.0 : static_cast<double>(frame.masses.front());
  } else {
    frame = read_particles(file.path);
    if (frame.size() == 0) fail("{}: has no particles: there is nothing to make a surface of", file.path.string());
    if (options.spacing) frame.spacing = spacing;
  }
  try {
    if (options.attributes) keep_attributes(frame, has_velocity, *options.attributes);
  } catch (const Error& error) {
    fail("{}: {}", file.path.string(), error.what());
  }
  return frame;
}

/// The first file of the series, asked for or not.
fs::path first_of_series(const std::vector<std::string>& names, const std::vector<ParticleFile>& files) {
  const auto pattern = names.size() == 1 ? parse_pattern(names.front()) : std::nullopt;
  return pattern ? pattern->path(frames_there(*pattern).front()) : files.front().path;
}

double estimate_spacing_of(const fs::path& path) {
  const ParticleCloud cloud = read_particle_cloud(path);
  try {
    return estimate_spacing(cloud.position);
  } catch (const Error& error) {
    fail("{}: {}", path.string(), error.what());
  }
}

/// settings.toml, beside the surfaces: what they depend on beside the particles, and which frames were made from that.
/// Several machines may make frames in one folder: each keeps what the others wrote.
class SeriesSettings {
 public:
  SeriesSettings(fs::path path, std::string text, bool resume)
      : path_(std::move(path)), text_(std::move(text)), shared_(resume) {
    if (shared_) made_ = read();
  }

  bool made(int frame) const { return made_.contains(frame); }

  /// Saved: what is cut off after it counts as not made.
  void set_made(int frame, bool made) {
    const FolderLock lock(path_.parent_path());
    if (shared_) made_ = read();
    shared_ = true;
    if (made)
      made_.insert(frame);
    else
      made_.erase(frame);
    write_file_atomically(path_, fmt::format("{}{}\n{}", heading, fmt::join(made_, " "), text_));
  }

 private:
  static constexpr std::string_view heading = "# frames = ";

  /// The frames that the file says were made from these settings.
  std::set<int> read() const {
    std::set<int> frames;
    if (!fs::exists(path_)) return frames;
    const std::string old = read_file(path_);
    const std::size_t end = old.find('\n');
    if (!old.starts_with(heading) || old.substr(end + 1) != text_) return frames;
    std::istringstream numbers(old.substr(heading.size(), end - heading.size()));
    for (int frame; numbers >> frame;) frames.insert(frame);
    return frames;
  }

  fs::path path_;
  std::string text_;
  bool shared_;  ///< another machine may have written to the file
  std::set<int> made_;
};

}  // namespace

std::vector<ParticleFile> find_particle_files(const std::vector<std::string>& names, const std::string& frames) {
  if (names.size() == 1)
    if (const auto pattern = parse_pattern(names.front())) return find_pattern_files(names.front(), *pattern, frames);
  std::vector<ParticleFile> files;
  for (const std::string& name : names) {
    if (parse_pattern(name)) fail("{}: a pattern must be the only name", name);
    if (!fs::exists(name)) fail("{}: there is no such file", name);
    files.push_back({name, frame_of(fs::path(name).stem().string()).value_or(static_cast<int>(files.size()) + 1)});
  }
  std::sort(files.begin(), files.end(), [](const ParticleFile& a, const ParticleFile& b) { return a.frame < b.frame; });
  for (std::size_t i = 1; i < files.size(); ++i)
    if (files[i].frame == files[i - 1].frame)
      fail("{} and {} are both frame {}: the last digits of a name are its frame", files[i - 1].path.string(),
           files[i].path.string(), files[i].frame);
  if (frames.empty()) return files;
  const FrameRange range =
      parse_frame_range(frames, frames.ends_with('-') ? files.back().frame : std::numeric_limits<int>::max());
  for (int frame = range.first; frame <= range.last; ++frame)
    if (std::none_of(files.begin(), files.end(), [&](const ParticleFile& f) { return f.frame == frame; }))
      fail("--frames {}: frame {} is missing among the files given", frames, frame);
  std::erase_if(files, [&](const ParticleFile& f) { return f.frame < range.first || f.frame > range.last; });
  return files;
}

SeriesSummary surface_series(const std::vector<std::string>& names, const std::string& frames,
                             const SeriesOptions& options, Progress& progress) {
  const std::vector<ParticleFile> files = find_particle_files(names, frames);
  const Scene settings = read_surface_settings(options.overrides);
  for (const ParticleFile& file : files)
    if (!is_particle_cloud(file.path) && lower_case_extension(file.path) != ".vdb")
      fail("{}: particles cannot be read from '{}' files; allowed are .vdb .ply .xyz .csv", file.path.string(),
           file.path.extension().string());

  SeriesSummary summary{fs::absolute(options.folder)};
  summary.spacing_is_estimated = !options.spacing && is_particle_cloud(files.front().path);
  if (options.spacing) summary.spacing = *options.spacing;
  if (summary.spacing_is_estimated) {
    const fs::path first = first_of_series(names, files);
    summary.spacing = estimate_spacing_of(first);
    progress.message(fmt::format("particles are {:.6g} m apart, as estimated from {}; --spacing_m sets it",
                                 summary.spacing, first.string()));
  }

  const OutputFolder folder{summary.folder};
  create_directories_or_fail(folder.surfaces());
  const std::string text =
      fmt::format("# spacing_m = {:.17g}, attributes = {}\n{}", summary.spacing,
                  options.attributes ? fmt::format("{}", fmt::join(*options.attributes, ",")) : "all",
                  write_section(settings, SceneSection::surface));
  SeriesSettings made_from(folder.surfaces() / "settings.toml", text, options.resume);
  EmptySurfaces empty(settings.surface, progress);
  for (const ParticleFile& file : files) {
    progress.update({"surface", file.frame, files.front().frame, files.back().frame, 0.0, ""});
    stop_if_asked(progress, "surface", file.frame);
    if (made_from.made(file.frame) && all_exist(surface_files(folder, file.frame, settings.surface_outputs))) {
      ++summary.n_kept;
      continue;
    }
    made_from.set_made(file.frame, false);
    const ParticleFrame particles = read_frame(file, summary.spacing, options);
    if (summary.spacing == 0.0) summary.spacing = particles.spacing;
    empty.look_at(file.frame, particles, make_surface_files(file.path, particles, settings, folder, file.frame));
    made_from.set_made(file.frame, true);
    ++summary.n_made;
  }
  empty.tell_how_many();
  return summary;
}

}  // namespace smelt
