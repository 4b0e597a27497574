#pragma once
// The files of a shot: the layout that scripts rely on.

#include <fmt/format.h>

#include <filesystem>
#include <string>

namespace smelt {

struct OutputFolder {
  std::filesystem::path root;

  std::filesystem::path scene() const { return root / "scene.toml"; }
  std::filesystem::path report() const { return root / "run.json"; }
  std::filesystem::path particles() const { return root / "particles"; }
  std::filesystem::path checkpoints() const { return root / "checkpoint"; }
  std::filesystem::path bodies() const { return root / "bodies"; }
  std::filesystem::path surfaces() const { return root / "surface"; }
  std::filesystem::path frames() const { return root / "frames"; }

  std::filesystem::path particles(int frame) const { return particles() / fmt::format("particles.{:04}.vdb", frame); }
  std::filesystem::path checkpoint(int frame) const {
    return checkpoints() / fmt::format("checkpoint.{:04}.bin", frame);
  }
  std::filesystem::path bodies(int frame) const { return bodies() / fmt::format("bodies.{:04}.json", frame); }
  std::filesystem::path surface_obj(int frame) const { return surfaces() / fmt::format("surface.{:04}.obj", frame); }
  std::filesystem::path surface_vdb(int frame) const { return surfaces() / fmt::format("surface.{:04}.vdb", frame); }
  std::filesystem::path exr(int frame) const { return frames() / fmt::format("frame.{:04}.exr", frame); }
  std::filesystem::path diagnostic(const std::string& colour_by, int frame) const {
    return root / "diagnostic" / fmt::format("{}.{:04}.png", colour_by, frame);
  }
  std::filesystem::path sheet() const { return root / "sheet.png"; }
  std::filesystem::path sheet(const std::string& colour_by) const {
    return root / fmt::format("sheet.{}.png", colour_by);
  }
  std::filesystem::path surface_ply(int frame) const { return surfaces() / fmt::format("surface.{:04}.ply", frame); }
  std::filesystem::path picture(int frame) const { return frames() / fmt::format("frame.{:04}.png", frame); }
};

}  // namespace smelt
