#include "scenes/film.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <vector>

extern char** environ;

namespace smelt {

namespace {

/// Runs a program found in PATH, silent; its exit status, or 127 where it could not be started.
int run_program(const std::vector<std::string>& arguments) {
  std::vector<char*> argv;
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) posix_spawn_file_actions_addopen(&actions, fd, "/dev/null", O_RDWR, 0);
  pid_t child = 0;
  const int error = posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return 127;
  int status = 0;
  if (waitpid(child, &status, 0) < 0 || !WIFEXITED(status)) return 126;
  return WEXITSTATUS(status);
}

}  // namespace

std::optional<std::filesystem::path> encode_film(const OutputFolder& folder, const std::string& name, int n_frames, double fps,
                                                 std::string& why_not) {
  for (int frame = 1; frame <= n_frames; ++frame) {
    if (std::filesystem::exists(folder.picture(frame))) continue;
    why_not = fmt::format("frame {} is missing", frame);
    return std::nullopt;
  }
  const auto film = folder.root / (name + ".mp4");
  const auto temporary = folder.root / (name + ".tmp.mp4");
  const int status = run_program({"ffmpeg", "-y", "-loglevel", "error", "-framerate", fmt::format("{}", fps), "-start_number", "1", "-i",
                                  (folder.frames() / "frame.%04d.png").string(), "-frames:v", fmt::to_string(n_frames), "-vf",
                                  "crop=trunc(iw/2)*2:trunc(ih/2)*2", "-c:v", "libx264", "-preset", "veryfast", "-crf", "18", "-pix_fmt",
                                  "yuv420p", "-movflags", "+faststart", temporary.string()});
  if (status == 0) {
    std::filesystem::rename(temporary, film);
    return film;
  }
  std::error_code ignored;
  std::filesystem::remove(temporary, ignored);
  why_not = status == 127 ? "ffmpeg is not installed" : fmt::format("ffmpeg failed with status {}", status);
  return std::nullopt;
}

}  // namespace smelt
