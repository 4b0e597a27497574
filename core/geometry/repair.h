#pragma once
// Making a mesh fit to be filled with particles: closed, wound outward, free of self-intersections.

#include "core/geometry/triangle_mesh.h"

#include <string>

namespace smelt {

/// What was found in a mesh and what was done about it.
struct MeshReport {
  MeshTopology topology;                 ///< of the mesh as given
  std::size_t n_self_intersections = 0;  ///< pairs of faces, of the mesh as given
  bool self_intersects = false;          ///< n_self_intersections > 0
  bool repaired = false;                 ///< the mesh handed back differs from the one given
  std::string description;  ///< in words, with counts: "12 boundary edges in 2 holes: filled with 10 faces"
};

struct RepairedMesh {
  TriangleMesh mesh;
  MeshReport report;
};

/// Refuses what is no surface at all. Throws Error (the caller adds the file's name) for a mesh without triangles, an
/// index out of range, a vertex that is not finite, or only faces without area. Open and flat ones pass: obstacles may
/// be sheets.
void validate_surface(const TriangleMesh& mesh);

/// Refuses what no repair can help. Throws Error (the caller adds the file's name) for a mesh without triangles, an
/// index out of range, a vertex that is not finite, only faces without area, or a flat mesh.
void validate_mesh(const TriangleMesh& mesh);

/// A closed mesh, wound outward and free of self-intersections, that bounds the same body. In this order:
///  1. a sound mesh is handed back unchanged;
///  2. faces wound inward, or against their neighbours, are turned;
///  3. holes are filled, which leaves every other face where it is;
///  4. what still is open or self-intersecting is wrapped (CGAL alpha_wrap_3 [Portaneri 2022]): the wrap follows the
///     surface at a distance of `spacing`/20 and bridges gaps narrower than two spacings. Where it crept in through a
///     wider gap and became a shell, the gap it may bridge is doubled until the wrap is solid.
/// `spacing` [m] is the distance between particles to come: details below it cannot be simulated and need not survive.
/// Wrapping adds about area * spacing/20 to the volume; the report's description gives the volume reached.
/// Throws Error as validate_mesh does, and where nothing solid comes out.
RepairedMesh repair(const TriangleMesh& mesh, double spacing);

}  // namespace smelt
