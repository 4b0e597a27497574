#pragma once
// Scenes as text: the scene as run with its defaults written out, and the reference page of all keys.

#include "scenes/schema.h"

#include <string>

namespace smelt {

/// The scene as TOML, every key written that has a value; read_scene gives the same scene back. Meshes outside smelt's
/// own folder are written with absolute paths, so that the text may be stored elsewhere.
std::string write_scene(const Scene& scene);

/// The keys that a stage depends on, as text: equal texts make equal results.
std::string write_section(const Scene& scene, SceneSection section);

/// docs/scene.md: every key with its meaning, allowed values and default.
std::string write_scene_reference();

}  // namespace smelt
