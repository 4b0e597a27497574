// Round things are drawn round, and boxes keep their edges.

#include "render/smooth_collider.h"

#include "tests/meshes.h"

#include <gtest/gtest.h>

namespace smelt {
namespace {

TEST(SmoothCollider, ASpheresNormalsAreRadial) {
  const ColliderView sphere = make_smooth_collider(make_sphere(Vec3::Zero(), 1.0, 3));
  ASSERT_EQ(sphere.normals.size(), sphere.mesh.vertices.size());
  for (std::size_t v = 0; v < sphere.normals.size(); ++v)
    EXPECT_GT(sphere.normals[v].cast<double>().dot(sphere.mesh.vertices[v]), 0.995) << v;
}

TEST(SmoothCollider, ABoxKeepsItsEdges) {
  const TriangleMesh box = make_box({0, 0, 0}, {1, 2, 3});
  const ColliderView view = make_smooth_collider(box);
  ASSERT_EQ(view.mesh.triangles.size(), box.triangles.size());
  for (std::size_t face = 0; face < box.triangles.size(); ++face) {
    const auto& t = box.triangles[face];
    const Vec3 normal =
        (box.vertices[t[1]] - box.vertices[t[0]]).cross(box.vertices[t[2]] - box.vertices[t[0]]).normalized();
    for (const std::uint32_t v : view.mesh.triangles[face])
      EXPECT_LT((view.normals[v].cast<double>() - normal).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace smelt
