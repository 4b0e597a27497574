#pragma once
// Exact time of contact of a moving sphere with a triangle (3D) or a segment (2D).
//
// [P 6.3] tests the sphere only at the time it meets the triangle's PLANE, and an edge only where the foot of the
// perpendicular is inside it: a grazing hit of an edge or a corner happens at another time. Here the sphere meets the
// Minkowski sum of the triangle and a ball: two faces, three edge cylinders, three corner balls; the earliest counts
// [Ericson 2005, 5.5.6].

#include "core/geometry/vec.h"

#include <array>
#include <optional>

namespace smelt {

/// Triangle corners in 3D, segment ends in 2D, a point in 1D.
template <int Dim>
using Simplex = std::array<Vec<Dim>, Dim>;

/// First touch of a sphere that moves along a straight line.
template <int Dim>
struct SweepContact {
  double time;      ///< fraction of the displacement, in [0, 1]
  Vec<Dim> normal;  ///< unit, from the obstacle to the sphere's centre at that time
};

/// The point of the simplex (two-sided) closest to `point`.
template <int Dim>
Vec<Dim> closest_point(const Vec<Dim>& point, const Simplex<Dim>& simplex);

/// Contact of a sphere at `centre` with radius `radius` > 0 [m] that moves by `displacement` [m]. A sphere that
/// overlaps at the start is in contact at time 0 where it moves deeper in, and free where it moves out, as it does in
/// any direction from a centre on the obstacle itself. Nothing where
/// they do not touch, nor, perhaps, where they touch later than `until` (fraction).
template <int Dim>
std::optional<SweepContact<Dim>> sweep_sphere(const Vec<Dim>& centre, const Vec<Dim>& displacement, double radius,
                                              const Simplex<Dim>& simplex, double until = 1.0);

}  // namespace smelt
