#pragma once
// Triangles (3D), segments (2D) and points (1D) as pieces of a surface with two sides.

#include "core/geometry/swept_sphere.h"

#include <Eigen/Geometry>

namespace smelt {

/// Unit normal by winding: counter-clockwise triangles seen from the side it points to; of a segment a -> b, the side
/// on the right (outward where the segments run counter-clockwise round a solid); +x in 1D. Zero for a facet without
/// area.
template <int Dim>
Vec<Dim> facet_normal(const Simplex<Dim>& facet) {
  Vec<Dim> normal;
  if constexpr (Dim == 3) {
    normal = (facet[1] - facet[0]).cross(facet[2] - facet[0]);
  } else if constexpr (Dim == 2) {
    const Vec<2> along = facet[1] - facet[0];
    normal = Vec<2>(along[1], -along[0]);
  } else {
    normal[0] = 1.0;
  }
  const double length = normal.norm();
  return length > 0.0 ? Vec<Dim>(normal / length) : Vec<Dim>(Vec<Dim>::Zero());
}

}  // namespace smelt
