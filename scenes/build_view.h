#pragma once
// From a scene to what the renderer draws around the fluid.

#include "render/scene_view.h"
#include "scenes/scene.h"

namespace smelt {

/// Camera, lights, look, ground and colliders; what the scene leaves out is chosen to show its bodies well.
RenderScene build_view(const Scene& scene);

}  // namespace smelt
