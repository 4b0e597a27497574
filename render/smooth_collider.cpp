#include "render/smooth_collider.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace smelt {

ColliderView make_smooth_collider(const TriangleMesh& mesh, double crease_deg) {
  const double least_cosine = std::cos(crease_deg * std::numbers::pi / 180.0);
  std::vector<Vec3> area;  // of each face, along its normal
  std::vector<std::vector<std::size_t>> faces_at(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) faces_at[v].push_back(area.size());
    area.push_back((mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]));
  }
  ColliderView view;
  for (std::size_t face = 0; face < mesh.triangles.size(); ++face)
    for (const std::uint32_t v : mesh.triangles[face]) {
      Vec3 sum = area[face];
      for (const std::size_t other : faces_at[v])
        if (other != face && area[other].dot(area[face]) > least_cosine * area[other].norm() * area[face].norm())
          sum += area[other];
      view.mesh.vertices.push_back(mesh.vertices[v]);
      view.normals.push_back(sum.stableNormalized().cast<float>());
    }
  for (std::uint32_t v = 0; v < view.mesh.vertices.size(); v += 3) view.mesh.triangles.push_back({v, v + 1, v + 2});
  return view;
}

}  // namespace smelt
