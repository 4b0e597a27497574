#pragma once
// A glowing surface as a source of light: points on it, in proportion to what its triangles give off.

#include "core/geometry/vec.h"
#include "render/sampling.h"

#include <cstdint>
#include <vector>

namespace smelt {

/// A point of a mesh.
struct MeshPoint {
  std::uint32_t triangle = 0;
  float u = 0.0f, v = 0.0f;  ///< the point is (1-u-v) a + u b + v c
};

/// A distribution over the triangles of a mesh, uniform within each.
class GlowLight {
 public:
  GlowLight() = default;
  /// `power[k]`: radiance times area of triangle k, summed over the colours; `area[k]` [m^2]; `middle[k]` relative to
  /// the renderer's origin [m].
  GlowLight(const std::vector<float>& power, std::vector<float> area, const std::vector<Vec3f>& middle);

  bool empty() const { return total_ <= 0.0f; }
  MeshPoint sample(Sample2 s) const;
  /// Density by area [1/m^2] of the points of a triangle.
  float pdf_area(std::uint32_t triangle) const;
  /// What the whole may send to a point, roughly, as LightSet weighs its lights.
  float weight_at(const Vec3f& point) const;

 private:
  std::vector<float> sums_;  ///< running sums of power
  std::vector<float> area_;
  float total_ = 0.0f;
  Vec3f centre_ = Vec3f::Zero();
  float spread2_ = 0.0f;  ///< mean square distance from the centre [m^2]
};

}  // namespace smelt
