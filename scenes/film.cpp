#include "scenes/film.h"

#include "io/run_program.h"

namespace smelt {

std::optional<std::filesystem::path> encode_film(const OutputFolder& folder, const std::string& name, int n_frames,
                                                 double fps, std::string& why_not) {
  for (int frame = 1; frame <= n_frames; ++frame) {
    if (std::filesystem::exists(folder.picture(frame))) continue;
    why_not = fmt::format("frame {} is missing", frame);
    return std::nullopt;
  }
  const auto film = folder.root / (name + ".mp4");
  const auto temporary = folder.root / (name + ".tmp.mp4");
  const int status =
      run_program({"ffmpeg", "-y", "-loglevel", "error", "-framerate", fmt::format("{}", fps), "-start_number", "1",
                   "-i", (folder.frames() / "frame.%04d.png").string(), "-frames:v", fmt::to_string(n_frames), "-vf",
                   "crop=trunc(iw/2)*2:trunc(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv",
                   // Said, or players guess: reds would shift.
                   "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "iec61966-2-1", "-color_range",
                   "tv", "-c:v", "libx264", "-preset", "veryfast", "-crf", "18", "-pix_fmt", "yuv420p", "-movflags",
                   "+faststart", temporary.string()});
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
