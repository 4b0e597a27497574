#pragma once
// Walls of many small facets: pieces of them small enough for one point each (docs/decisions/0014-fine-walls.md).

#include "core/geometry/swept_sphere.h"

#include <cstdint>
#include <span>
#include <vector>

namespace smelt {

/// A piece of a wall.
struct WallSample {
  Vec3 centre;  ///< [m]
  Vec3 area;    ///< along its normal, front side by winding [m^2]
  Mat3 spread;  ///< mean of (x - centre) (x - centre)^T over it [m^2]
};

/// Samples of like normals about one plane, as a particle sees them.
struct WallPatch {
  Vec3 area = Vec3::Zero();  ///< sum over what began it [m^2]
  double plane = 0.0;        ///< distance of the particle in front of it [m]
  std::vector<WallSample> samples;
};

/// Patches of one query; kept for the next one, so that it need not ask for memory again.
struct WallPatches {
  std::vector<WallPatch> patch;
  std::size_t n = 0;  ///< of them are in use
};

/// The facets of one obstacle in a tree, each node with its area vector, so that what is far or small is seen as a
/// whole. Queries may run on many threads at once.
class WallTree {
 public:
  explicit WallTree(std::span<const Simplex<3>> facets);

  /// What stands for the facets within `reach` of `point` in integrals over kernels of smoothing length h, until the
  /// point has moved by `slack`: samples no larger (in radius) than 0.35 of their distance and than 0.4 h, in patches
  /// of like normals (some ten degrees) and planes (h/4); and the indices, unordered, of facets too large or too near
  /// for that. Appends to `facets`, overwrites `patches`.
  void gather(const Vec3& point, double h, double reach, double slack, WallPatches& patches,
              std::vector<std::uint32_t>& facets) const;

 private:
  struct Node {
    Vec3 centre = Vec3::Zero();  ///< of area
    Vec3 area = Vec3::Zero();    ///< sum of area vectors
    Mat3 spread = Mat3::Zero();
    double radius = 0.0;               ///< of a ball about `centre` that holds all corners
    bool flat = false;                 ///< normals within some ten degrees of their mean
    std::uint32_t begin = 0, end = 0;  ///< of its facets in order_
    std::uint32_t left = 0;            ///< child; the right one follows it; 0: a leaf
  };
  /// A facet as one sample.
  struct Leaf {
    WallSample sample;
    double radius;
  };
  struct Query;
  void build(std::uint32_t node);
  void visit(std::uint32_t node, int patch, Query& query) const;
  void visit_facet(std::uint32_t k, int patch, Query& query) const;

  std::span<const Simplex<3>> facets_;
  std::vector<std::uint32_t> order_;
  std::vector<Leaf> leaves_;  ///< in that order
  std::vector<Node> nodes_;
};

}  // namespace smelt
