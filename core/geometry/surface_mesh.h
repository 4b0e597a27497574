#pragma once
// The surface of a fluid at one frame: what surfacing makes, io writes and render draws.

#include "core/geometry/triangle_mesh.h"

#include <vector>

namespace smelt {

/// A triangle mesh with per-vertex attributes. `normals` and `velocity` have one entry per vertex; `temperature`,
/// `viscosity` and `rest` one per vertex or none, where the scene has no such field.
struct SurfaceMesh {
  TriangleMesh mesh;
  std::vector<Vec3f> normals;      ///< unit, outward
  std::vector<Vec3f> velocity;     ///< [m/s]
  std::vector<float> temperature;  ///< [K], or empty
  std::vector<float> viscosity;    ///< [Pa s], or empty
  std::vector<Vec3f> rest;         ///< where the material was before it moved [m], or empty
};

}  // namespace smelt
