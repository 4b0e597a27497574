#pragma once
// `quality = "preview" | "final" | "study"`: settings that were measured to suit a purpose (docs/accuracy.md).

#include "scenes/scene.h"

#include <string_view>

namespace smelt {

/// Makes the settings of `quality` the defaults of a scene that is not read yet; of an unknown one nothing.
void set_defaults_for(std::string_view quality, Scene& scene);

/// What a quality changes in what the scene says, once it is read: a preview has a quarter of the particles. Then the
/// quality is done with: a scene that is written out says its settings one by one, and is not coarsened again where it
/// is read.
void apply_quality(Scene& scene);

}  // namespace smelt
