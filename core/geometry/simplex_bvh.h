#pragma once
// Finds the triangles (3D, Embree) or segments (2D) near a point.

#include "core/geometry/swept_sphere.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace smelt {

/// A bounding volume hierarchy over triangles or segments. Queries may run on many threads at once.
template <int Dim>
class SimplexBvh {
 public:
  explicit SimplexBvh(std::vector<Simplex<Dim>> simplices);
  ~SimplexBvh();
  SimplexBvh(SimplexBvh&&) noexcept;
  SimplexBvh& operator=(SimplexBvh&&) noexcept;

  const std::vector<Simplex<Dim>>& simplices() const { return simplices_; }

  /// Appends the indices, ascending, of all simplices that come closer than `radius` [m] to `point`, and perhaps a few
  /// more.
  void find_near(const Vec<Dim>& point, double radius, std::vector<std::uint32_t>& found) const;

  /// From `point` to the nearest simplex [m], to a rounding of Embree's floats never too much; `limit` [m] where none is nearer than that.
  double distance(const Vec<Dim>& point, double limit) const;

 private:
  struct Index;
  std::vector<Simplex<Dim>> simplices_;
  std::unique_ptr<Index> index_;
};

}  // namespace smelt
