#pragma once
// A closed mesh around the inside of a function.

#include "core/geometry/triangle_mesh.h"

#include <functional>

namespace smelt {

/// The surface where `distance` is 0, inside where it is negative, by the marching cubes of surfacing/ on cells of
/// `cell`, smoothed `passes` times with its volume kept. `distance` need only be continuous, but vertices sit best
/// where it is linear across a cell. The surface must lie inside `box`. All in one unit of length.
TriangleMesh make_implicit_mesh(const std::function<double(const Vec3&)>& distance, const Box3& box, double cell,
                                int passes);

}  // namespace smelt
