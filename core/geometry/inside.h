#pragma once
// What is inside a closed mesh, decided along lines parallel to the x axis.

#include "core/geometry/triangle_mesh.h"

namespace smelt {

/// Where a line along x passes through a surface.
struct Crossing {
  double x;     ///< [m]
  int winding;  ///< change of the winding number for greater x: +1 into the body, -1 out of it
};

/// The faces of a mesh, sorted into square bins of the y-z plane. Which faces a line crosses is decided with exact
/// predicates, so that no line slips through between two faces; only x is rounded. Keeps a reference to the mesh. May
/// be used by many threads.
class InsideTest {
 public:
  /// `line_spacing` [m]: about how far apart the lines asked for will be; it sizes the bins and changes no result.
  InsideTest(const TriangleMesh& mesh, double line_spacing);

  const Box3& bounds() const { return bounds_; }

  /// All crossings of the line (y, z), by ascending x; overwrites `crossings`.
  void intersect(double y, double z, std::vector<Crossing>& crossings) const;

  /// Whether the winding number of `p` differs from zero. `crossings` is scratch space.
  bool contains(const Vec3& p, std::vector<Crossing>& crossings) const;

 private:
  std::size_t bin_y(double y) const { return static_cast<std::size_t>((y - bounds_.lower.y()) / bin_width_); }
  std::size_t bin_z(double z) const { return static_cast<std::size_t>((z - bounds_.lower.z()) / bin_width_); }

  const TriangleMesh& mesh_;
  Box3 bounds_;
  double bin_width_ = 0.0;
  std::size_t n_y_ = 0, n_z_ = 0;
  std::vector<std::vector<std::uint32_t>> faces_in_bin_;
};

}  // namespace smelt
