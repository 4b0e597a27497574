#pragma once
// Light from all directions by an image: what it sends, and directions drawn in proportion to it.

#include "core/geometry/vec.h"
#include "render/sampling.h"
#include "render/scene_view.h"

#include <vector>

namespace smelt {

/// An Environment ready for sampling. Radiance is interpolated between the middles of its pixels.
class EnvironmentMap {
 public:
  explicit EnvironmentMap(const Environment& environment);

  /// Radiance from the unit direction `d`.
  Vec3f radiance(const Vec3f& d) const;
  /// A unit direction whose density is nearly in proportion to the radiance, and never 0 where that is not.
  Vec3f sample(Sample2 s) const;
  /// That density [1/sr].
  float pdf(const Vec3f& d) const;
  /// Mean over the sphere of red + green + blue.
  float mean_sum() const { return mean_sum_; }

 private:
  struct Place {
    float x, y;  ///< in pixels from the top left corner
  };
  Place place_of(const Vec3f& d) const;

  Environment environment_;
  float rotation_;                ///< [rad]
  std::vector<float> row_sums_;   ///< running sums over rows, of weight
  std::vector<float> cell_sums_;  ///< running sums within each row
  float mean_sum_ = 0.0f;
};

}  // namespace smelt
