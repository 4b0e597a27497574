#pragma once
// What a scene file must satisfy beyond the type and range of each key.

#include "scenes/scene.h"

#include <string>
#include <vector>

namespace smelt {

/// Errors of one scene file, each with its place.
class SceneErrors {
 public:
  explicit SceneErrors(std::string file) : places_(std::move(file)) {}

  KeyPlaces& places() { return places_; }

  /// `key_path` need not exist (KeyPlaces::find).
  void add(const std::string& key_path, const std::string& what);

  /// Throws Error with all of them, in the order of the file.
  void throw_if_any() const;

 private:
  struct Entry {
    int line;
    std::string text;
  };
  KeyPlaces places_;
  std::vector<Entry> entries_;
};

/// Adds what contradicts itself or the world: count against spacing, jump number against rest viscosity, names, files,
/// ranges.
void validate_scene(const Scene& scene, SceneErrors& errors);

}  // namespace smelt
