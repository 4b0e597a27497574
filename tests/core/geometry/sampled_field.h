#pragma once
// The inside of a mesh by another way than core/geometry/inside.h: the sign of OpenVDB's distance field.

#include "core/geometry/triangle_mesh.h"

#include <openvdb/math/Proximity.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <limits>

namespace smelt {

inline openvdb::Vec3d to_vdb(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

/// A mesh as meshToVolume wants it. Keeps references.
struct MeshAdapter {
  const TriangleMesh& mesh;
  const openvdb::math::Transform& transform;

  std::size_t polygonCount() const { return mesh.triangles.size(); }
  std::size_t pointCount() const { return mesh.vertices.size(); }
  std::size_t vertexCount(std::size_t) const { return 3; }
  void getIndexSpacePoint(std::size_t face, std::size_t corner, openvdb::Vec3d& p) const {
    p = transform.worldToIndex(to_vdb(mesh.vertices[mesh.triangles[face][corner]]));
  }
};

/// The field [m] of `mesh` on voxels of `voxel_size` [m], one of them about `origin`; negative inside, three voxels to
/// either side.
inline openvdb::FloatGrid::Ptr make_field(const TriangleMesh& mesh, double voxel_size, const Vec3& origin) {
  const openvdb::math::Transform::Ptr transform = openvdb::math::Transform::createLinearTransform(voxel_size);
  transform->postTranslate(to_vdb(origin));
  return openvdb::tools::meshToVolume<openvdb::FloatGrid>(MeshAdapter{mesh, *transform}, *transform);
}

/// Says where a field is negative, between voxels by trilinear interpolation. One for each thread.
class FieldSign {
 public:
  explicit FieldSign(const openvdb::FloatGrid& field)
      : accessor_(field.getConstAccessor()), transform_(field.transform()) {}
  bool contains(const Vec3& p) const {
    return openvdb::tools::BoxSampler::sample(accessor_, transform_.worldToIndex(to_vdb(p))) < 0.0f;
  }

 private:
  openvdb::FloatGrid::ConstAccessor accessor_;
  const openvdb::math::Transform& transform_;
};

/// Distance [m] between `p` and the nearest face, by trying all of them.
inline double distance_to_surface(const TriangleMesh& mesh, const Vec3& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : mesh.triangles) {
    openvdb::Vec3d weights;
    const openvdb::Vec3d on_face = openvdb::math::closestPointOnTriangleToPoint(
        to_vdb(mesh.vertices[a]), to_vdb(mesh.vertices[b]), to_vdb(mesh.vertices[c]), to_vdb(p), weights);
    nearest = std::min(nearest, (on_face - to_vdb(p)).length());
  }
  return nearest;
}

}  // namespace smelt
