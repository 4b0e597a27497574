#pragma once
// Meshes drawn round where they are meant to be round.

#include "render/scene_view.h"

namespace smelt {

/// The mesh with normals: at each corner of a face the mean, by area, of the face and of those faces at the same vertex
/// that lean less than `crease_deg` from it. Edges sharper than that stay edges. Each face has three vertices of its
/// own.
ColliderView make_smooth_collider(const TriangleMesh& mesh, double crease_deg = 40.0);

}  // namespace smelt
