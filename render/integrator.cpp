#include "render/integrator.h"

#include "render/film.h"

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

/// Which pair of random numbers serves which decision at the first surface.
enum Dimension : std::uint32_t {
  dim_scatter = first_surface_dimension,
  dim_scatter_choice,
  dim_lamp,
  dim_lamp_choice,
  dim_bounce,
  dim_coat_lamp,
  dim_coat,
  dim_coat_choice,
  dim_lobe,
  first_body_path = 16,   ///< bounces that begin at the body
  first_coat_path = 112,  ///< and at the coat
};

/// The same after the first surface, counted from the start of a bounce.
enum BounceDimension : std::uint32_t {
  dim_bounce_light,
  dim_bounce_choice,
  dim_bounce_direction,
  dim_bounce_fate,
  dims_per_bounce,
};

enum class Lobe : std::uint8_t { none, body, coat };

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

/// One vertex of a path: light drawn there, and the ray that goes on. What either brings is multiplied by its weight.
struct Vertex {
  Vec3f direct = Vec3f::Zero();  ///< from a light, if `shadow` meets nothing
  Ray shadow;
  Vec3f weight = Vec3f::Zero();  ///< of what `ray` brings
  Ray ray;
  float pdf = 0.0f;  ///< [1/sr] of the ray's direction
};
using VertexPacket = std::array<Vertex, packet_size>;

RayPacket rays_of(const VertexPacket& vertices, Ray Vertex::*ray) {
  RayPacket rays;
  for (std::size_t i = 0; i < packet_size; ++i) rays[i] = vertices[i].*ray;
  return rays;
}

void aim_at_light(const ShadingScene& scene, const SurfacePoint& point, const LightSample& light, float time,
                  Vertex& vertex) {
  vertex.shadow = ray_from(scene, point, light.direction, light.distance);
  vertex.shadow.time = time;
  if (!std::isfinite(light.distance)) return;
  // From where the ray was lifted to: aimed as from the point itself it would end behind what is near and glows.
  const Vec3f to = point.position + light.direction * light.distance - vertex.shadow.origin;
  const float distance = to.norm();
  vertex.shadow.direction = to / distance;
  vertex.shadow.t_far = 0.999f * distance;
}

/// A white diffusing body; `share(cosine)` is what of the light from there comes through its coat.
template <typename Share>
void scatter_diffuse(const ShadingScene& scene, const SurfacePoint& point, float time, const Share& share,
                     Sample2 at_light, float which_light, Sample2 direction, Vertex& vertex) {
  if (scene.lights().any()) {
    const LightSample light = scene.sample_light(point.position, at_light, which_light, time);
    const float cos_in = point.normal.dot(light.direction);
    if (light.pdf > 0.0f && cos_in > 0.0f) {
      const float chance = power_heuristic(light.pdf, cos_in / pi_f);
      vertex.direct = light.radiance * (cos_in * share(cos_in) * chance / (pi_f * light.pdf));
      aim_at_light(scene, point, light, time, vertex);
    }
  }
  const Vec3f local = sample_cosine_hemisphere(direction);
  vertex.weight = Vec3f::Constant(share(local.z()));
  vertex.ray = ray_from(scene, point, Frame(point.normal).to_world(local), far_away);
  vertex.ray.time = time;
  vertex.pdf = local.z() / pi_f;
}

/// What a mirroring surface does to light, but for the shape of its lobe: Fresnel's share, and more for metals.
class Mirror {
 public:
  Mirror(const ShadingScene& scene, const SurfacePoint& point, float cos_out)
      : metal_(point.metal), ior_(scene.view().look.ior) {
    if (metal_) {
      f0_ = point.albedo;
      scale_ = multiple_scattering(scene.mirror_albedo(), f0_, cos_out, point.roughness);
    } else {
      scale_ = Vec3f::Constant(point.specular);
    }
  }
  Vec3f operator()(float cosine) const {
    return metal_ ? Vec3f(scale_.cwiseProduct(fresnel_metal(f0_, cosine)))
                  : Vec3f(scale_ * fresnel_dielectric(cosine, ior_));
  }

 private:
  bool metal_;
  float ior_;
  Vec3f f0_ = Vec3f::Zero(), scale_;
};

/// A coat or a metal, seen from `view` (unit, towards the eye).
void scatter_mirror(const ShadingScene& scene, const SurfacePoint& point, const Vec3f& view, float time,
                    Sample2 at_light, float which_light, Sample2 direction, Vertex& vertex) {
  const Frame frame(point.normal);
  Vec3f wo = frame.to_local(view);
  // Interpolated normals may lean away from the eye at silhouettes: such points are seen edge on.
  wo.z() = std::max(wo.z(), 1e-3f);
  wo.normalize();
  const float alpha = ggx_alpha(point.roughness);
  const Mirror mirror(scene, point, wo.z());
  if (scene.lights().any()) {
    const LightSample light = scene.sample_light(point.position, at_light, which_light, time);
    const Vec3f to_light = frame.to_local(light.direction);
    if (light.pdf > 0.0f && to_light.z() > 0.0f) {
      const float chance = power_heuristic(light.pdf, ggx_reflection_pdf(to_light, wo, alpha));
      const float lobe = ggx_mirror(to_light, wo, alpha) * to_light.z() * chance / light.pdf;
      vertex.direct = light.radiance.cwiseProduct(mirror((to_light + wo).normalized().dot(wo))) * lobe;
      aim_at_light(scene, point, light, time, vertex);
    }
  }
  const Vec3f half = sample_ggx_visible_normal(wo, alpha, direction);
  const Vec3f wi = half * (2.0f * half.dot(wo)) - wo;
  if (wi.z() <= 0.0f) return;
  const float masking = 1.0f + ggx_lambda(wo, alpha);
  vertex.weight = mirror(half.dot(wo)) * (masking / (masking + ggx_lambda(wi, alpha)));
  vertex.ray = ray_from(scene, point, frame.to_world(wi), far_away);
  vertex.ray.time = time;
  vertex.pdf = ggx_reflection_pdf(wi, wo, alpha);
}

/// The last surface of a path: one light, or one ray to the sky, which the lights leave out.
void end_at_surface(const ShadingScene& scene, const SurfacePoint& point, float time, Sample2 where, Sample2 which,
                    Vertex& vertex) {
  const bool lit = scene.lights().any(), sky = scene.lights().has_sky();
  const float to_light = lit ? (sky ? 0.5f : 1.0f) : 0.0f;
  if (which.v < to_light) {
    const LightSample light = scene.sample_light(point.position, where, which.u, time);
    const float cos_in = point.normal.dot(light.direction);
    if (light.pdf <= 0.0f || cos_in <= 0.0f) return;
    vertex.direct = light.radiance * (cos_in / (pi_f * light.pdf * to_light));
    aim_at_light(scene, point, light, time, vertex);
  } else if (sky) {
    const Vec3f direction = Frame(point.normal).to_world(sample_cosine_hemisphere(where));
    vertex.direct = scene.lights().sky(direction) / (1.0f - to_light);
    vertex.shadow = ray_from(scene, point, direction, far_away);
    vertex.shadow.time = time;
  }
}

/// Emission of the surface that a ray from `origin` met, weighed against the chance to draw it as a light.
Vec3f met_emission(const ShadingScene& scene, const Ray& ray, const SurfacePoint& point, float pdf) {
  if (point.emission.isZero(0.0f) || point.kind != SurfaceKind::fluid) return point.emission;
  const float cosine = -point.geometric_normal.dot(ray.direction);
  return point.emission * power_heuristic(pdf, scene.lights().glow_pdf(ray.origin, point.triangle, point.t, cosine));
}

/// Follows one path past its first surface.
class PathPacket {
 public:
  PathPacket(const ShadingScene& scene, Samples samples, const PathOptions& options, const VertexPacket& vertices,
             const std::array<std::uint32_t, packet_size>& first_dimension)
      : scene_(scene), samples_(samples), options_(options), first_dimension_(first_dimension), vertices_(vertices) {
    radiance_ = black();
    throughput_ = black();
    for (std::size_t i = 0; i < samples.size(); ++i) throughput_[i] = vertices_[i].weight;
  }

  /// Radiance that the vertices' rays bring, weighed.
  const ColourPacket& trace() {
    for (int bounce = 1;; ++bounce) {
      const bool last = bounce == options_.n_bounces;
      if (!meet_surfaces(bounce, last ? Then::end : Then::go_on)) return radiance_;
      const auto blocked = scene_.occluded(rays_of(vertices_, &Vertex::shadow));
      for (std::size_t i = 0; i < samples_.size(); ++i)
        if (vertices_[i].shadow.active && !blocked[i]) radiance_[i] += carried_[i].cwiseProduct(vertices_[i].direct);
      if (!last) continue;
      meet_surfaces(bounce + 1,
                    Then::stop);  // what the last metals mirror: lamps, sky and glow, but no surface's light
      return radiance_;
    }
  }

 private:
  enum class Then { go_on, end, stop };  ///< of the surfaces met: leave them, leave metals alone, or leave none

  /// Adds what the rays meet, and makes those surfaces the new vertices; false where none is left.
  bool meet_surfaces(int bounce, Then then) {
    RayPacket rays = rays_of(vertices_, &Vertex::ray);
    std::array<LampHit, packet_size> lamps;
    bool any = false;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      if (!rays[i].active) continue;
      any = true;
      lamps[i] = scene_.lights().nearest_lamp(rays[i].origin, rays[i].direction, vertices_[i].pdf);
      rays[i].t_far = lamps[i].distance;
    }
    if (!any) return false;
    const SurfacePacket points = scene_.intersect(rays);
    any = false;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const float pdf = vertices_[i].pdf;
      vertices_[i] = {};
      if (!rays[i].active) continue;
      if (points[i].kind == SurfaceKind::none) {
        const Vec3f arriving = lamps[i].distance < far_away
                                   ? lamps[i].radiance
                                   : scene_.lights().far_radiance(rays[i].origin, rays[i].direction, pdf);
        radiance_[i] += throughput_[i].cwiseProduct(arriving);
        continue;
      }
      // A floor faded away shows the sky's edge in reflections, as the backdrop does to the camera.
      const SurfacePoint& point = points[i];
      Vec3f seen = met_emission(scene_, rays[i], point, pdf);
      if (point.fade > 0.0f) seen += scene_.lights().far_radiance(rays[i].origin, rays[i].direction, pdf) * point.fade;
      radiance_[i] += throughput_[i].cwiseProduct(seen);
      if (point.fade >= 1.0f) continue;
      throughput_[i] *= 1.0f - point.fade;
      if (then == Then::stop) continue;
      leave_surface(i, rays[i], point, bounce, then == Then::end);
      any = true;
    }
    return any;
  }

  void leave_surface(std::size_t i, const Ray& ray, const SurfacePoint& point, int bounce, bool last) {
    const PixelSampler& random = samples_[i].sampler;
    const std::uint32_t first = first_dimension_[i] + static_cast<std::uint32_t>(bounce - 1) * dims_per_bounce;
    const Sample2 where = random.draw(first + dim_bounce_light), which = random.draw(first + dim_bounce_choice);
    Vertex& vertex = vertices_[i];
    if (last && !point.metal) {
      end_at_surface(scene_, point, ray.time, where, which, vertex);
      carried_[i] = throughput_[i].cwiseProduct(point.albedo);
      return;
    }
    const Sample2 direction = random.draw(first + dim_bounce_direction);
    Vec3f colour = Vec3f::Ones();
    if (point.metal) {
      scatter_mirror(scene_, point, -ray.direction, ray.time, where, which.u, direction, vertex);
    } else {
      scatter_diffuse(
          scene_, point, ray.time, [](float) { return 1.0f; }, where, which.u, direction, vertex);
      colour = point.albedo;
    }
    carried_[i] = throughput_[i].cwiseProduct(colour);
    throughput_[i] = carried_[i].cwiseProduct(vertex.weight);
    if (bounce >= 2) play_roulette(i, random.draw(first + dim_bounce_fate).u);
  }

  /// Ends dim paths by chance; those that survive stand for them.
  void play_roulette(std::size_t i, float fate) {
    const float chance = std::clamp(throughput_[i].maxCoeff(), 0.05f, 1.0f);
    if (fate < chance)
      throughput_[i] /= chance;
    else
      vertices_[i].ray.active = false;
  }

  const ShadingScene& scene_;
  Samples samples_;
  const PathOptions& options_;
  const std::array<std::uint32_t, packet_size>& first_dimension_;
  VertexPacket vertices_;
  ColourPacket throughput_, carried_, radiance_;
};

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

std::array<Entry, packet_size> scatter_inside(const ShadingScene& scene, const SurfacePacket& points,
                                              const std::array<Lobe, packet_size>& lobes, Samples samples) {
  std::array<Entry, packet_size> entries;
  RayPacket probes;
  std::array<float, packet_size> fate{};
  std::array<bool, packet_size> crossing{};
  const Vec3f tint = scene.view().look.scatter_tint;
  const float widest_tint = tint.maxCoeff();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const SurfacePoint& point = points[i];
    if (lobes[i] != Lobe::body) continue;
    entries[i].point = point;
    if (point.scatter <= 0.0f) continue;
    const Sample2 choice = samples[i].sampler.draw(dim_scatter_choice);
    crossing[i] = choice.u < 0.5f;
    fate[i] = choice.v;
    const float widest = point.scatter * widest_tint;
    if (crossing[i]) {
      probes[i] = ray_from(scene, point, -point.normal, -crossing_reach * widest * std::log(std::max(fate[i], 1e-6f)));
      probes[i].time = samples[i].time;
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
    probe.time = samples[i].time;
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

/// Chance of the coat where a sample follows one lobe: its share of what is reflected, but never so small that
/// highlights would be rare.
float coat_chance(const ShadingScene& scene, const SurfacePoint& point, const Vec3f& direction) {
  if (point.metal) return 1.0f;
  if (point.specular <= 0.0f) return 0.0f;
  const float cos_out = std::max(0.0f, -point.normal.dot(direction));
  const float coat = point.specular * scene.coat_albedo()(cos_out, point.roughness);
  return std::clamp(coat / (coat + (1.0f - coat) * point.albedo.maxCoeff()), 0.25f, 0.75f);
}

/// Light that leaves the first surfaces by the lobes given, from a vertex there on.
struct Bounced {
  ColourPacket direct = black();
  ColourPacket indirect = black();
};

class FirstSurface {
 public:
  FirstSurface(const ShadingScene& scene, const SurfacePacket& points, Samples samples, const PathOptions& options)
      : scene_(scene), points_(points), samples_(samples), options_(options) {}

  Bounced trace(const std::array<Lobe, packet_size>& lobes) const {
    VertexPacket vertices;
    std::array<std::uint32_t, packet_size> first_dimension{};
    const std::array<Entry, packet_size> entries = scatter_inside(scene_, points_, lobes, samples_);
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      first_dimension[i] = lobes[i] == Lobe::coat ? first_coat_path : first_body_path;
      if (lobes[i] == Lobe::body) leave_body(i, entries[i], vertices[i]);
      if (lobes[i] == Lobe::coat) leave_coat(i, vertices[i]);
    }
    Bounced bounced;
    const auto blocked = scene_.occluded(rays_of(vertices, &Vertex::shadow));
    for (std::size_t i = 0; i < samples_.size(); ++i)
      if (vertices[i].shadow.active && !blocked[i]) bounced.direct[i] = vertices[i].direct;
    bounced.indirect = PathPacket(scene_, samples_, options_, vertices, first_dimension).trace();
    return bounced;
  }

 private:
  void leave_body(std::size_t i, const Entry& entry, Vertex& vertex) const {
    const SurfacePoint& point = points_[i];
    const PixelSampler& random = samples_[i].sampler;
    const float cos_out = std::max(0.0f, -point.normal.dot(samples_[i].direction));
    const CoatedDiffuse coated(scene_.coat_albedo(), cos_out, point.specular, point.roughness);
    const auto share = [&](float cos_in) { return coated(scene_.coat_albedo(), cos_in); };
    scatter_diffuse(scene_, entry.point, samples_[i].time, share, random.draw(dim_lamp), random.draw(dim_lamp_choice).u,
                    random.draw(dim_bounce), vertex);
    vertex.direct = vertex.direct.cwiseProduct(entry.weight);
    vertex.weight = vertex.weight.cwiseProduct(entry.weight);
  }

  void leave_coat(std::size_t i, Vertex& vertex) const {
    const PixelSampler& random = samples_[i].sampler;
    scatter_mirror(scene_, points_[i], -samples_[i].direction, samples_[i].time, random.draw(dim_coat_lamp),
                   random.draw(dim_coat_choice).u, random.draw(dim_coat), vertex);
  }

  const ShadingScene& scene_;
  const SurfacePacket& points_;
  Samples samples_;
  const PathOptions& options_;
};

/// Keeps what bounces bring below the limit; returns the luminance taken away.
float limit_fireflies(Vec3f& radiance, float limit) {
  const float l = luminance(radiance);
  if (limit <= 0.0f || l <= limit) return 0.0f;
  radiance *= limit / l;
  return l - limit;
}

/// Adds a lobe's light, which stands for `weight` of its kind, to the sample.
void add_lobe(SampleRadiance& sample, Lobe lobe, const Vec3f& direct, Vec3f indirect, float weight, float limit) {
  const float taken = limit_fireflies(indirect, limit);
  const Vec3f sum = (direct + indirect) * weight;
  if (lobe == Lobe::coat) {
    sample.specular += sum;
    sample.clamped += taken * weight;
  } else {
    sample.light += sum;
    sample.clamped += taken * weight * luminance(sample.albedo);
  }
}

}  // namespace

std::array<SampleRadiance, packet_size> trace_packet(const ShadingScene& scene, Samples samples,
                                                     const PathOptions& options) {
  // What the camera sees.
  std::array<SampleRadiance, packet_size> result;
  RayPacket rays;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    rays[i].origin = samples[i].origin;
    rays[i].direction = samples[i].direction;
    rays[i].time = samples[i].time;
    rays[i].active = true;
    rays[i].meshes = samples[i].meshes;
  }
  const SurfacePacket points = scene.intersect(rays, true);
  std::array<Lobe, packet_size> bodies{}, coats{};
  bool any_coat = false;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const SurfacePoint& point = points[i];
    result[i].kind = point.kind;
    result[i].fade = point.kind == SurfaceKind::none ? 1.0f : point.fade;
    if (result[i].fade > 0.0f) result[i].emission = scene.background(samples[i].direction) * result[i].fade;
    if (point.kind == SurfaceKind::none) continue;
    result[i].emission += point.emission;
    result[i].colour = point.albedo;
    if (!point.metal) result[i].albedo = point.albedo * (1.0f - point.fade);
    result[i].normal = point.normal;
    result[i].position = point.position;
    result[i].velocity = point.velocity;
    result[i].temperature = point.temperature;
    if (point.fade >= 1.0f) continue;
    if (!point.metal) bodies[i] = Lobe::body;
    if (point.metal || point.specular > 0.0f) coats[i] = Lobe::coat;
    any_coat = any_coat || coats[i] == Lobe::coat;
  }

  const FirstSurface surface(scene, points, samples, options);
  if (options.both_lobes) {
    const Bounced body = surface.trace(bodies);
    for (std::size_t i = 0; i < samples.size(); ++i)
      add_lobe(result[i], Lobe::body, body.direct[i], body.indirect[i], 1.0f, options.firefly_limit);
    if (!any_coat) return result;
    const Bounced coat = surface.trace(coats);
    for (std::size_t i = 0; i < samples.size(); ++i)
      add_lobe(result[i], Lobe::coat, coat.direct[i], coat.indirect[i], 1.0f, options.firefly_limit);
    return result;
  }

  // One lobe a sample, which stands for both.
  std::array<Lobe, packet_size> lobes = bodies;
  std::array<float, packet_size> weight{};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    weight[i] = 1.0f;
    if (coats[i] == Lobe::none) continue;
    const float chance = coat_chance(scene, points[i], samples[i].direction);
    const bool coat = samples[i].sampler.draw(dim_lobe).u < chance;
    if (coat) lobes[i] = Lobe::coat;
    weight[i] = 1.0f / (coat ? chance : 1.0f - chance);
  }
  const Bounced bounced = surface.trace(lobes);
  for (std::size_t i = 0; i < samples.size(); ++i)
    add_lobe(result[i], lobes[i], bounced.direct[i], bounced.indirect[i], weight[i], options.firefly_limit);
  return result;
}

}  // namespace smelt
