#include "render/integrator.h"

#include "render/sky.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace smelt {

namespace {

/// Which pair of random numbers serves which decision (0 is the place in the pixel, drawn by the caller).
enum Dimension : std::uint32_t {
  dim_scatter = 1,
  dim_scatter_choice,
  dim_lamp,
  dim_lamp_choice,
  dim_bounce,
  dim_bounce_light,
  dim_coat_lamp,
  dim_coat,
  dim_coat_bounce,
  dim_coat_choice
};

using ColourPacket = std::array<Vec3f, packet_size>;
using Samples = std::span<const CameraSample>;

ColourPacket black() {
  ColourPacket packet;
  packet.fill(Vec3f::Zero());
  return packet;
}

Ray ray_from(const ShadingScene& scene, const SurfacePoint& point, const Vec3f& direction, float distance) {
  Ray ray;
  // The lift grows with distance from the eye as the floats' spacing does.
  const float lift = scene.ray_offset() + 2e-6f * point.position.cwiseAbs().maxCoeff();
  const float side = point.geometric_normal.dot(direction) < 0.0f ? -1.0f : 1.0f;
  ray.origin = point.position + point.geometric_normal * (side * lift);
  ray.direction = direction;
  ray.t_far = distance;
  ray.active = true;
  return ray;
}

constexpr float far_away = std::numeric_limits<float>::infinity();

/// Radiance that arrives along the rays: `miss` where they meet nothing, otherwise the surface's diffuse light,
/// estimated from a lamp or from the sky with equal chance.
ColourPacket arriving_radiance(const ShadingScene& scene, const RayPacket& rays, const ColourPacket& miss,
                               Samples samples, Dimension where, Dimension choice) {
  const SurfacePacket points = scene.intersect(rays);
  ColourPacket result = miss;
  ColourPacket sent = black();
  RayPacket shadow;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const SurfacePoint& point = points[i];
    if (!rays[i].active || point.kind == SurfaceKind::none) continue;
    // A floor faded away shows the sky's edge in reflections, as the backdrop does to the camera.
    result[i] = sky_radiance(scene.view().sky, rays[i].direction) * point.fade;
    if (point.fade >= 1.0f) continue;
    const Vec3f weight = point.albedo * (2.0f * (1.0f - point.fade));
    const Sample2 place = samples[i].sampler.draw(where);
    const Sample2 which = samples[i].sampler.draw(choice);
    if (which.v < 0.5f && !scene.lamps().empty()) {
      const LightSample light = sample_lights(scene.lamps(), point.position, place, which.u);
      const float cos_in = point.normal.dot(light.direction);
      if (light.pdf <= 0.0f || cos_in <= 0.0f) continue;
      sent[i] = weight.cwiseProduct(light.radiance) * (cos_in / (pi_f * light.pdf));
      shadow[i] = ray_from(scene, point, light.direction, light.distance * 0.999f);
    } else {
      const Vec3f direction = Frame(point.normal).to_world(sample_cosine_hemisphere(place));
      const float share = scene.lamps().empty() ? 0.5f : 1.0f;
      sent[i] = weight.cwiseProduct(sky_radiance(scene.view().sky, direction)) * share;
      shadow[i] = ray_from(scene, point, direction, far_away);
    }
  }
  const auto blocked = scene.occluded(shadow);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (shadow[i].active && !blocked[i]) result[i] += sent[i];
  }
  return result;
}

/// Where the light that leaves at a point has entered, and what colour of it survives the way.
struct Entry {
  SurfacePoint point;
  Vec3f weight = Vec3f::Ones();
};

/// Ratio of each colour's diffusion profile at radius r to the one r was drawn from (the widest).
Vec3f profile_weight(const Vec3f& distance, float widest, float r) {
  auto profile = [r](float d) { return (std::exp(-r / d) + std::exp(-r / (3.0f * d))) / d; };
  const float drawn = profile(widest);
  return {profile(distance.x()) / drawn, profile(distance.y()) / drawn, profile(distance.z()) / drawn};
}

/// Light crosses a part of thickness t with chance 1/2 e^(-t / 4d), d being the scatter distance: the reach of the
/// diffusion profile's tail, halved as half of the light turns back.
constexpr float crossing_reach = 4.0f;

std::array<Entry, packet_size> scatter_inside(const ShadingScene& scene, const SurfacePacket& points, Samples samples) {
  std::array<Entry, packet_size> entries;
  RayPacket probes;
  std::array<float, packet_size> fate{};
  std::array<bool, packet_size> crossing{};
  const Vec3f tint = scene.view().look.scatter_tint;
  const float widest_tint = tint.maxCoeff();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const SurfacePoint& point = points[i];
    entries[i].point = point;
    if (point.scatter <= 0.0f) continue;
    const Sample2 choice = samples[i].sampler.draw(dim_scatter_choice);
    crossing[i] = choice.u < 0.5f;
    fate[i] = choice.v;
    const float widest = point.scatter * widest_tint;
    if (crossing[i]) {
      probes[i] = ray_from(scene, point, -point.normal, -crossing_reach * widest * std::log(std::max(fate[i], 1e-6f)));
      continue;
    }
    const Sample2 s = samples[i].sampler.draw(dim_scatter);
    const float r = sample_diffusion_radius(s.u, widest);
    entries[i].weight = profile_weight(tint * point.scatter, widest, r);
    const Frame frame(point.normal);
    const float angle = 2.0f * pi_f * s.v;
    Ray probe;
    probe.origin = point.position + frame.tangent * (r * std::cos(angle)) + frame.bitangent * (r * std::sin(angle)) +
                   point.normal * r;
    probe.direction = -point.normal;
    probe.t_far = 2.0f * r;
    probe.active = r > scene.ray_offset();
    probes[i] = probe;
  }
  if (std::none_of(probes.begin(), probes.end(), [](const Ray& probe) { return probe.active; })) return entries;
  const HitPacket hits = scene.intersect_meshes(probes);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!probes[i].active || hits[i].geometry != 0) continue;
    SurfacePoint found = scene.resolve(probes[i], hits[i]);
    if (crossing[i]) {
      // resolve() faces the ray, which comes from inside; the light enters from outside.
      found.normal = -found.normal;
      found.geometric_normal = -found.geometric_normal;
      const Vec3f reach = tint * (crossing_reach * found.scatter);
      const float widest = reach.maxCoeff();
      for (int c = 0; c < 3; ++c) entries[i].weight[c] = std::exp(found.t / widest - found.t / reach[c]);
    }
    entries[i].point = found;
  }
  return entries;
}

/// `light` of the samples: direct from the lamps and from everything around, at the points where light enters.
void add_diffuse(const ShadingScene& scene, const SurfacePacket& points, Samples samples,
                 std::array<SampleRadiance, packet_size>& result) {
  const std::array<Entry, packet_size> entries = scatter_inside(scene, points, samples);
  RayPacket shadow, bounce;
  ColourPacket direct = black(), weight = black(), sky = black();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const SurfacePoint& point = points[i];
    if (point.kind == SurfaceKind::none || point.fade >= 1.0f) continue;
    const SurfacePoint& entry = entries[i].point;
    const PixelSampler& random = samples[i].sampler;
    const float cos_out = std::max(0.0f, -point.normal.dot(samples[i].direction));
    const CoatedDiffuse diffuse(scene.coat_albedo(), cos_out, point.specular, point.roughness);

    const LightSample light =
        sample_lights(scene.lamps(), entry.position, random.draw(dim_lamp), random.draw(dim_lamp_choice).u);
    const float cos_in = entry.normal.dot(light.direction);
    if (light.pdf > 0.0f && cos_in > 0.0f) {
      direct[i] = entries[i].weight.cwiseProduct(light.radiance) *
                  (cos_in * diffuse(scene.coat_albedo(), cos_in) / (pi_f * light.pdf));
      shadow[i] = ray_from(scene, entry, light.direction, light.distance * 0.999f);
    }
    const Vec3f local = sample_cosine_hemisphere(random.draw(dim_bounce));
    const Vec3f direction = Frame(entry.normal).to_world(local);
    weight[i] = entries[i].weight * diffuse(scene.coat_albedo(), local.z());
    bounce[i] = ray_from(scene, entry, direction, far_away);
    sky[i] = sky_radiance(scene.view().sky, direction);
  }
  const auto blocked = scene.occluded(shadow);
  const ColourPacket arriving = arriving_radiance(scene, bounce, sky, samples, dim_bounce_light, dim_lamp_choice);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!bounce[i].active) continue;
    result[i].light = weight[i].cwiseProduct(arriving[i]);
    if (shadow[i].active && !blocked[i]) result[i].light += direct[i];
  }
}

float power_heuristic(float mine, float other) {
  return mine * mine / (mine * mine + other * other);
}

/// What a ray meets among the lamps: the nearest one.
struct LampHit {
  float distance = far_away;
  Vec3f radiance = Vec3f::Zero();  ///< weighted against sample_lights' chance of the same direction
};

LampHit nearest_lamp(const ShadingScene& scene, const Vec3f& origin, const Vec3f& direction, float pdf) {
  LampHit nearest;
  std::optional<std::size_t> which;
  for (std::size_t i = 0; i < scene.lamps().size(); ++i) {
    const auto t = intersect_lamp(scene.lamps()[i], origin, direction);
    if (!t || *t >= nearest.distance) continue;
    nearest.distance = *t;
    which = i;
  }
  if (which) {
    const float other = light_pdf(scene.lamps(), *which, origin, direction, nearest.distance);
    nearest.radiance = scene.lamps()[*which].radiance * power_heuristic(pdf, other);
  }
  return nearest;
}

/// `specular` of the samples: what the coat mirrors.
void add_coat(const ShadingScene& scene, const SurfacePacket& points, Samples samples,
              std::array<SampleRadiance, packet_size>& result) {
  RayPacket shadow, mirror;
  ColourPacket direct = black(), miss = black();
  std::array<float, packet_size> weight{};
  const float ior = scene.view().look.ior;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const SurfacePoint& point = points[i];
    if (point.specular <= 0.0f) continue;
    const PixelSampler& random = samples[i].sampler;
    const Frame frame(point.normal);
    Vec3f wo = frame.to_local(-samples[i].direction);
    // Interpolated normals may lean away from the eye at silhouettes: such points are seen edge on.
    wo.z() = std::max(wo.z(), 1e-3f);
    wo.normalize();
    const float alpha = ggx_alpha(point.roughness);

    const LightSample light =
        sample_lights(scene.lamps(), point.position, random.draw(dim_coat_lamp), random.draw(dim_coat_choice).u);
    const Vec3f to_lamp = frame.to_local(light.direction);
    if (light.pdf > 0.0f && to_lamp.z() > 0.0f) {
      const float chance = power_heuristic(light.pdf, ggx_reflection_pdf(to_lamp, wo, alpha));
      const float reflection = ggx_reflection(to_lamp, wo, alpha, ior) * to_lamp.z();
      direct[i] = light.radiance * (point.specular * reflection * chance / light.pdf);
      shadow[i] = ray_from(scene, point, light.direction, light.distance * 0.999f);
    }
    const Vec3f half = sample_ggx_visible_normal(wo, alpha, random.draw(dim_coat));
    const Vec3f wi = half * (2.0f * half.dot(wo)) - wo;
    if (wi.z() <= 0.0f) continue;
    const float masking = ggx_lambda(wo, alpha);
    weight[i] = point.specular * fresnel_dielectric(half.dot(wo), ior) * (1.0f + masking) /
                (1.0f + masking + ggx_lambda(wi, alpha));
    const Vec3f direction = frame.to_world(wi);
    const LampHit lamp = nearest_lamp(scene, point.position, direction, ggx_reflection_pdf(wi, wo, alpha));
    miss[i] = lamp.distance < far_away ? lamp.radiance : sky_radiance(scene.view().sky, direction);
    mirror[i] = ray_from(scene, point, direction, lamp.distance);
  }
  const auto blocked = scene.occluded(shadow);
  const ColourPacket arriving = arriving_radiance(scene, mirror, miss, samples, dim_coat_bounce, dim_coat_choice);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (mirror[i].active) result[i].specular = arriving[i] * weight[i];
    if (shadow[i].active && !blocked[i]) result[i].specular += direct[i];
  }
}

}  // namespace

std::array<SampleRadiance, packet_size> trace_packet(const ShadingScene& scene, Samples samples) {
  std::array<SampleRadiance, packet_size> result;
  RayPacket rays;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    rays[i].direction = samples[i].direction;
    rays[i].active = true;
    rays[i].meshes = samples[i].meshes;
  }
  const SurfacePacket points = scene.intersect(rays, true);
  bool any_coat = false;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const SurfacePoint& point = points[i];
    const Vec3f backdrop = backdrop_radiance(scene.view().backdrop, samples[i].direction);
    result[i].kind = point.kind;
    if (point.kind == SurfaceKind::none) {
      result[i].emission = backdrop;
      continue;
    }
    result[i].emission = backdrop * point.fade;
    result[i].albedo = point.albedo * (1.0f - point.fade);
    result[i].normal = point.normal;
    result[i].position = point.position;
    any_coat = any_coat || point.specular > 0.0f;
  }
  add_diffuse(scene, points, samples, result);
  if (any_coat) add_coat(scene, points, samples, result);
  return result;
}

}  // namespace smelt
