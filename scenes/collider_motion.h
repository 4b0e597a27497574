#pragma once
// How the colliders of a scene move.

#include "core/geometry/motion.h"
#include "core/geometry/triangle_mesh.h"
#include "scenes/scene.h"

namespace smelt {

/// The motion that a scene gives a collider whose mesh is `at_rest` where the scene places it.
Motion<3> to_motion(const ColliderSettings& settings, const TriangleMesh& at_rest);

/// Turns about x, then y, then z.
Mat3 rotation_from_degrees(const Vec3& degrees);

/// `mesh` taken to where `pose` puts it.
TriangleMesh moved(const TriangleMesh& mesh, const Pose<3>& pose);

}  // namespace smelt
