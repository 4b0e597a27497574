#pragma once
// From a scene to what the renderer draws around the fluid.

#include "io/body_poses.h"
#include "render/render_frame.h"
#include "render/scene_view.h"
#include "scenes/scene.h"

namespace smelt {

/// Camera, lights, look, ground and colliders; what the scene leaves out is chosen to show its bodies well.
RenderScene build_view(const Scene& scene);

/// How the pictures are computed.
RenderOptions to_options(const RenderSettings& settings);

/// Moves the colliders of a view that build_view() made to where they are at `time` [s], and rigid bodies to where
/// `bodies` has them; `at_rest`: the meshes it gave them.
void place_colliders(const Scene& scene, double time, const std::vector<BodyPose>& bodies,
                     const std::vector<ColliderView>& at_rest, RenderScene& view);

/// Where the scene's keyframes put a camera that build_view() made at `time` [s]; that camera itself without keyframes.
Camera camera_at(const Scene& scene, const Camera& camera, double time);

}  // namespace smelt
