#pragma once
// Letters as solids, from the outlines of a font.

#include "core/geometry/triangle_mesh.h"

#include <filesystem>
#include <string>

namespace smelt {

/// `text` (ASCII) in one line, set in the font of `font_file`: its baseline on y = 0, its width centred on x = 0,
/// facing +z, between z = -depth/2 and z = depth/2. Capitals are about 0.7 high: a unit is the em. Curves are chords no
/// longer than about `chord`. Each letter is closed; letters must not touch. Throws Error where FreeType cannot read
/// the font or it lacks a letter.
TriangleMesh make_extruded_text(const std::filesystem::path& font_file, const std::string& text, double depth,
                                double chord);

}  // namespace smelt
