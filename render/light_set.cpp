#include "render/light_set.h"

#include <cmath>
#include <numbers>

namespace smelt {

namespace {

constexpr float far_away = std::numeric_limits<float>::infinity();

/// Takes entries one after the other; each displaces the one held so far with its share of the weight up to here.
class Choice {
 public:
  explicit Choice(float u) : u_(u) {}
  bool offer(float weight) {
    if (!(weight > 0.0f)) return false;
    total += weight;
    const float chance = weight / total;
    if (u_ < chance) {
      chosen_weight = weight;
      u_ /= chance;
      return true;
    }
    u_ = (u_ - chance) / (1.0f - chance);
    return false;
  }
  float chance() const { return chosen_weight / total; }
  float total = 0.0f, chosen_weight = 0.0f;

 private:
  float u_;
};

}  // namespace

bool LightSet::SunCone::contains(const Vec3f& d) const {
  return 0.5f * (d - direction).squaredNorm() <= one_minus_cos;
}

LightSet::LightSet(const RenderScene& scene, const Vec3& origin, GlowLight glow)
    : sky_(scene.sky), glow_(std::move(glow)) {
  for (const AreaLight& light : scene.lights) lamps_.push_back(place_lamp(light, origin));
  if (scene.sun) {
    const double angle = scene.sun->angular_radius_deg * std::numbers::pi / 180.0;
    const double half = std::sin(0.5 * angle), one_minus_cos = 2.0 * half * half;
    SunCone cone{scene.sun->direction.normalized().cast<float>(), static_cast<float>(one_minus_cos),
                 static_cast<float>(2.0 * std::numbers::pi * one_minus_cos), scene.sun->radiance, 0.0f};
    cone.weight = cone.radiance.sum() * cone.solid_angle;
    if (cone.weight > 0.0f) sun_ = cone;
  }
  if (scene.environment) {
    environment_.emplace(*scene.environment);
    environment_weight_ = pi_f * environment_->mean_sum();
  }
}

float LightSet::total_weight(const Vec3f& point) const {
  float total = (sun_ ? sun_->weight : 0.0f) + environment_weight_ + (glow_.empty() ? 0.0f : glow_.weight_at(point));
  for (const LampGeometry& lamp : lamps_) total += choice_weight(lamp, point);
  return total;
}

LightSample LightSet::sample(const Vec3f& point, Sample2 where, float which) const {
  Choice choice(which);
  const LampGeometry* lamp = nullptr;
  bool sun = false, environment = false, glow = false;
  for (const LampGeometry& l : lamps_)
    if (choice.offer(choice_weight(l, point))) lamp = &l;
  if (sun_) sun = choice.offer(sun_->weight);
  if (environment_) environment = choice.offer(environment_weight_);
  if (!glow_.empty()) glow = choice.offer(glow_.weight_at(point));

  LightSample sample;
  if (choice.chosen_weight <= 0.0f) return sample;
  sample.distance = far_away;
  if (glow) {
    sample.glow = glow_.sample(where);
    sample.pdf = choice.chance();
  } else if (environment) {
    sample.direction = environment_->sample(where);
    sample.radiance = environment_->radiance(sample.direction);
    sample.pdf = choice.chance() * environment_->pdf(sample.direction);
  } else if (sun) {
    const float one_minus_cos = where.v * sun_->one_minus_cos, phi = 2.0f * pi_f * where.u;
    const float sine = std::sqrt(one_minus_cos * (2.0f - one_minus_cos));
    sample.direction = Frame(sun_->direction)
                           .to_world({sine * std::cos(phi), sine * std::sin(phi), 1.0f - one_minus_cos})
                           .normalized();
    sample.radiance = sun_->radiance;
    sample.pdf = choice.chance() / sun_->solid_angle;
  } else {
    const Vec3f to_lamp = sample_lamp(*lamp, where) - point;
    sample.distance = to_lamp.norm();
    if (sample.distance <= 0.0f) return {};
    sample.direction = to_lamp / sample.distance;
    const float facing = -sample.direction.dot(lamp->normal);
    if (facing <= 1e-6f) return {};
    sample.radiance = lamp->radiance;
    sample.pdf = choice.chance() * sample.distance * sample.distance / (facing * lamp->area);
  }
  return sample;
}

float LightSet::lamp_pdf(const LampGeometry& lamp, const Vec3f& point, const Vec3f& direction, float distance) const {
  const float facing = -direction.dot(lamp.normal);
  if (facing <= 1e-6f) return 0.0f;
  return choice_weight(lamp, point) / total_weight(point) * distance * distance / (facing * lamp.area);
}

LampHit LightSet::nearest_lamp(const Vec3f& point, const Vec3f& direction, float pdf) const {
  LampHit nearest;
  const LampGeometry* which = nullptr;
  for (const LampGeometry& lamp : lamps_) {
    const auto t = intersect_lamp(lamp, point, direction);
    if (!t || *t >= nearest.distance) continue;
    nearest.distance = *t;
    which = &lamp;
  }
  if (which != nullptr)
    nearest.radiance = which->radiance * power_heuristic(pdf, lamp_pdf(*which, point, direction, nearest.distance));
  return nearest;
}

Vec3f LightSet::sky(const Vec3f& direction) const {
  return environment_ ? Vec3f::Zero() : sky_radiance(sky_, direction);
}

Vec3f LightSet::far_radiance(const Vec3f& point, const Vec3f& direction, float pdf) const {
  Vec3f radiance = sky(direction);
  const bool in_sun = sun_ && sun_->contains(direction);
  const bool lit_by_map = environment_ && environment_weight_ > 0.0f;  // a panorama may be black
  if (!in_sun && !lit_by_map) return radiance;
  const float per_total = 1.0f / total_weight(point);
  if (in_sun) radiance += sun_->radiance * power_heuristic(pdf, sun_->weight * per_total / sun_->solid_angle);
  if (lit_by_map)
    radiance += environment_->radiance(direction) *
                power_heuristic(pdf, environment_weight_ * per_total * environment_->pdf(direction));
  return radiance;
}

Vec3f LightSet::far_radiance(const Vec3f& direction) const {
  Vec3f radiance = environment_ ? environment_->radiance(direction) : sky_radiance(sky_, direction);
  if (sun_ && sun_->contains(direction)) radiance += sun_->radiance;
  return radiance;
}

float LightSet::glow_pdf(const Vec3f& point, std::uint32_t triangle, float distance, float cosine) const {
  if (glow_.empty() || cosine <= 1e-6f) return 0.0f;
  const float chance = glow_.weight_at(point) / total_weight(point);
  return chance * glow_.pdf_area(triangle) * distance * distance / cosine;
}

}  // namespace smelt
