#include "render/glow_light.h"

#include <algorithm>
#include <cmath>

namespace smelt {

GlowLight::GlowLight(const std::vector<float>& power, std::vector<float> area, const std::vector<Vec3f>& middle)
    : area_(std::move(area)) {
  double total = 0.0;
  Vec3 moment = Vec3::Zero();
  sums_.reserve(power.size());
  for (std::size_t k = 0; k < power.size(); ++k) {
    total += power[k];
    moment += power[k] * middle[k].cast<double>();
    sums_.push_back(static_cast<float>(total));
  }
  total_ = static_cast<float>(total);
  if (!(total > 0.0)) return;
  const Vec3 centre = moment / total;
  double spread = 0.0;
  for (std::size_t k = 0; k < power.size(); ++k) spread += power[k] * (middle[k].cast<double>() - centre).squaredNorm();
  centre_ = centre.cast<float>();
  spread2_ = static_cast<float>(spread / total);
}

MeshPoint GlowLight::sample(Sample2 s) const {
  const float value = s.u * total_;
  const auto found = std::min(std::upper_bound(sums_.begin(), sums_.end(), value), sums_.end() - 1);
  const float before = found == sums_.begin() ? 0.0f : *(found - 1);
  const float rest = std::clamp((value - before) / std::max(*found - before, 1e-30f), 0.0f, 1.0f);
  const float root = std::sqrt(rest);
  return {static_cast<std::uint32_t>(found - sums_.begin()), root * (1.0f - s.v), root * s.v};
}

float GlowLight::pdf_area(std::uint32_t triangle) const {
  const float before = triangle == 0 ? 0.0f : sums_[triangle - 1];
  return area_[triangle] > 0.0f ? (sums_[triangle] - before) / (total_ * area_[triangle]) : 0.0f;
}

float GlowLight::weight_at(const Vec3f& point) const {
  // A closed surface turns a quarter of itself, on average, to any one side.
  return 0.25f * total_ / ((point - centre_).squaredNorm() + spread2_ + 1e-20f);
}

}  // namespace smelt
