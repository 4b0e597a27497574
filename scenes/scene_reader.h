#pragma once
// Scene files: reading, with every error of a file reported at once.

#include "scenes/scene.h"

#include <filesystem>
#include <string>
#include <vector>

namespace smelt {

/// Reads and validates a scene. `overrides` are "key.path=value" as given to --set; entries of [[tables]] are counted
/// from 0 ("body.0.scale=0.1"); a value that is no TOML is taken as text. Throws Error whose text has a line
/// "file:line: key: what, and what is allowed" for each unknown key (with the nearest known one), wrong type, missing
/// key, value out of range, unknown material and mesh file not found.
Scene read_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides = {});

/// The defaults of [surface] with `overrides` ("surface.iso_value=0.4") applied, in a scene that holds nothing else.
/// Throws Error as read_scene does; keys of other tables are refused.
Scene read_surface_settings(const std::vector<std::string>& overrides);

/// The mesh file that a scene means: as given if absolute, else from the scene's folder, else from smelt's own folder.
/// Throws Error that says where it was looked for.
std::filesystem::path find_mesh(const Scene& scene, const std::string& mesh);

/// smelt's own folder, where `assets/` and `scenes/` are.
std::filesystem::path smelt_folder();

}  // namespace smelt
