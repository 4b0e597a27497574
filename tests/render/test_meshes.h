#pragma once
// Shapes whose pictures are known.

#include "bench/cases/white_room.h"

namespace smelt::test {

using furnace::make_sphere;
using furnace::white_room;

/// A flat quad from corner `a` along `u` and `v`, facing u x v.
inline TriangleMesh make_quad(const Vec3& a, const Vec3& u, const Vec3& v) {
  return {{a, a + u, a + u + v, a + v}, {{0, 1, 2}, {0, 2, 3}}};
}

}  // namespace smelt::test
