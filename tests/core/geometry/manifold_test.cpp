#include "core/geometry/manifold.h"

#include "tests/meshes.h"

#include <gtest/gtest.h>

namespace smelt {
namespace {

TEST(Manifold, CountsVerticesWhereFansMeet) {
  const TriangleMesh box = make_box(Vec3::Zero(), Vec3::Ones());
  EXPECT_EQ(count_nonmanifold_vertices(box), 0u);
  // A second box that touches the first in a corner, and in an edge.
  const auto touching = [&](const Vec3& lower) {
    return weld(joined(box, make_box(lower, lower + Vec3::Ones())), 1e-9);
  };
  EXPECT_EQ(count_nonmanifold_vertices(touching(Vec3(1, 1, 1))), 1u);
  EXPECT_EQ(compute_topology(touching(Vec3(1, 1, 1))).n_nonmanifold_edges, 0u) << "which edges do not tell";
  // An open mesh is a manifold with a boundary.
  TriangleMesh open = box;
  open.triangles.pop_back();
  EXPECT_EQ(count_nonmanifold_vertices(open), 0u);
}

}  // namespace
}  // namespace smelt
