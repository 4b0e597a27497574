#pragma once
// A frame that cannot be drawn does not keep the others from being drawn.

#include "core/error.h"
#include "scenes/progress.h"

#include <filesystem>
#include <new>
#include <string>
#include <utility>

namespace smelt {

/// Some frames of a stage could not be made; the others are done, and later stages can go on with them.
class FramesFailed : public Error {
 public:
  using Error::Error;
};

/// Runs the work of one frame after another and remembers what went wrong.
class FailedFrames {
 public:
  FailedFrames(std::string stage, std::filesystem::path scene_file, Progress& progress)
      : stage_(std::move(stage)), scene_file_(std::move(scene_file)), progress_(progress) {}

  /// Does the work; an Error, or memory running out, is told to the user and kept, but not a disk that is full.
  template <typename Work>
  void attempt(int frame, const Work& work) {
    try {
      work();
    } catch (const WriteError&) {
      throw;
    } catch (const Error& error) {
      keep(frame, error.what());
    } catch (const std::bad_alloc&) {
      keep(frame, "out of memory; a smaller picture (camera.width, camera.height) or a coarser surface would do");
    }
  }

  /// Throws FramesFailed with the first of them, if there was any.
  void throw_if_any() const {
    if (n_failed_ == 0) return;
    if (n_failed_ == 1) throw FramesFailed(first_);
    throw FramesFailed(
        fmt::format("{}\n  and {} more frames of stage \"{}\"; the others are done", first_, n_failed_ - 1, stage_));
  }

 private:
  void keep(int frame, const std::string& what) {
    const std::string text = fmt::format("{}: frame {}: {}", scene_file_.string(), frame, what);
    if (n_failed_++ == 0) first_ = text;
    // A folder without surfaces need not say so for every frame.
    if (n_failed_ <= 3) progress_.message("error: " + text);
  }

  std::string stage_;
  std::filesystem::path scene_file_;
  Progress& progress_;
  std::string first_;
  int n_failed_ = 0;
};

}  // namespace smelt
