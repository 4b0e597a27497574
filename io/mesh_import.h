#pragma once
// Meshes made elsewhere: OBJ, PLY, STL, OFF, glTF.

#include "core/geometry/triangle_mesh.h"

#include <filesystem>

namespace smelt {

/// Reads a mesh through assimp: .obj .ply .stl .off .gltf .glb. Node transforms are applied, all meshes of the file
/// joined, polygons triangulated, points and lines left out, vertices within 1e-7 of the bounds' diagonal welded.
/// Coordinates pass through float (assimp) and are taken as metres, y up. Throws Error with the path for a missing,
/// empty, truncated or malformed file, an extension not in the list (it is given), a file without triangles, and a
/// vertex that is not finite. Holes and winding are not judged here: see repair().
TriangleMesh import_mesh(const std::filesystem::path& path);

}  // namespace smelt
