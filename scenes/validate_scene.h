#pragma once
// What a scene file must satisfy beyond the type and range of each key.

#include "io/toml.h"
#include "scenes/scene.h"

#include <map>
#include <string>
#include <vector>

namespace smelt {

/// Errors of one scene file, each with its place.
class SceneErrors {
 public:
  explicit SceneErrors(std::string file) : file_(std::move(file)) {}

  /// Remembers where a key stands.
  void locate(const std::string& key_path, const toml::source_region& source) {
    lines_[key_path] = static_cast<int>(source.begin.line);
  }
  /// Remembers that a key was set on the command line, as `text`.
  void overridden(const std::string& key_path, const std::string& text) { overrides_[key_path] = text; }

  /// `key_path` need not exist: the line is then that of the innermost table around it that does.
  void add(const std::string& key_path, const std::string& what);

  /// Throws Error with all of them, in the order of the file.
  void throw_if_any() const;

 private:
  struct Entry {
    int line;
    std::string text;
  };
  std::string file_;
  std::map<std::string, int> lines_;
  std::map<std::string, std::string> overrides_;
  std::vector<Entry> entries_;
};

/// Adds what contradicts itself or the world: count against spacing, jump number against rest viscosity, names, files, ranges.
void validate_scene(const Scene& scene, SceneErrors& errors);

}  // namespace smelt
