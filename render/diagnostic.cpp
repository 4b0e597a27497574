#include "render/diagnostic.h"

#include "core/error.h"
#include "render/camera.h"
#include "render/embree_scene.h"
#include "render/lettering.h"
#include "render/sky.h"
#include "render/tone_map.h"

#include <Eigen/Geometry>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

const Vec3f paper = Vec3f::Constant(0.95f), floor_grey = Vec3f::Constant(0.72f);

/// Where the four rays of a pixel go: a rotated grid.
constexpr std::array<std::pair<float, float>, 4> places{
    {{0.375f, 0.125f}, {0.875f, 0.375f}, {0.125f, 0.625f}, {0.625f, 0.875f}}};

class DiagnosticScene {
 public:
  DiagnosticScene(const DiagnosticPicture& picture, const RenderScene& scene)
      : picture_(picture), scene_(scene), camera_(scene.camera), eye_(scene.camera.eye) {
    solids_.add_spheres(picture.position, picture.radius, eye_);
    for (const ColliderView& collider : scene.colliders) solids_.add_mesh(collider.mesh, eye_);
    solids_.commit();
    if (picture.overlay != SurfaceOverlay::none) skin_.add_mesh(picture.surface->mesh, eye_);
    skin_.commit();
    colours_.reserve(picture.value.size());
    for (const float value : picture.value) colours_.push_back(map_(static_cast<float>(picture.scale.place(value))));
  }

  const ColourMap& map() const { return map_; }

  /// Linear display colour of two neighbouring pixels, four rays each.
  std::array<Vec3f, 2> pixels(int x, int y) const {
    RayPacket rays;
    for (std::size_t i = 0; i < packet_size; ++i) {
      const auto& place = places[i % 4];
      rays[i].direction = camera_.direction(x + static_cast<int>(i / 4) + static_cast<double>(place.first),
                                            y + static_cast<double>(place.second));
      rays[i].active = true;
    }
    const HitPacket hits = solids_.intersect(rays, true);
    HitPacket skin;
    if (picture_.overlay != SurfaceOverlay::none) skin = skin_.intersect(rays, true);
    std::array<Vec3f, 2> colour{Vec3f::Zero(), Vec3f::Zero()};
    for (std::size_t i = 0; i < packet_size; ++i) colour[i / 4] += 0.25f * seen(rays[i], hits[i], skin[i]);
    return colour;
  }

 private:
  Vec3f seen(const Ray& ray, const RayHit& hit, const RayHit& skin) const {
    float t = hit.t;
    Vec3f colour = solid(ray, hit, t);
    if (skin.geometry < 0 || skin.t > t) return colour;
    if (picture_.overlay == SurfaceOverlay::wire) return on_wire(ray, skin) ? Vec3f(Vec3f::Constant(0.02f)) : colour;
    const Vec3f normal = skin.normal.normalized();
    const float facing = std::abs(normal.dot(ray.direction));
    // Seen edge on, the way through it is long.
    return mix(Vec3f(0.55f, 0.70f, 0.85f) * (0.5f + 0.5f * facing), colour, 0.25f + 0.55f * facing);
  }

  /// What is opaque; `t` becomes its distance.
  Vec3f solid(const Ray& ray, const RayHit& hit, float& t) const {
    const float floor = floor_distance(ray);
    if (floor < t) {
      t = floor;
      return floor_colour(ray, floor);
    }
    if (hit.geometry < 0) return paper;
    Vec3f normal = hit.normal.normalized();
    if (normal.dot(ray.direction) > 0.0f) normal = -normal;
    const float facing = -normal.dot(ray.direction);
    const float light = 0.25f + 0.45f * facing + 0.30f * std::max(0.0f, normal.y());
    if (hit.geometry == 0) return colours_[hit.triangle] * std::min(1.0f, light + 0.1f);
    return Vec3f::Constant(0.62f) * light;
  }

  float floor_distance(const Ray& ray) const {
    if (!scene_.ground.enabled || ray.direction.y() >= 0.0f) return std::numeric_limits<float>::infinity();
    return static_cast<float>(scene_.ground.height - eye_.y()) / ray.direction.y();
  }

  Vec3f floor_colour(const Ray& ray, float t) const {
    const Vec3f at = ray.direction * t - (scene_.ground.centre - eye_).cast<float>();
    const float distance = std::sqrt(at.x() * at.x() + at.z() * at.z());
    return mix(floor_grey, paper,
               smooth_step(0.5f * static_cast<float>(scene_.ground.fade_start),
                           static_cast<float>(scene_.ground.fade_end), distance));
  }

  /// Whether a place of the surface is within half a pixel of an edge of its triangle.
  bool on_wire(const Ray& ray, const RayHit& hit) const {
    const auto& corners = picture_.surface->mesh.triangles[hit.triangle];
    const auto at = [&](std::size_t k) -> Vec3f {
      return (picture_.surface->mesh.vertices[corners[k]] - eye_).cast<float>();
    };
    const Vec3f a = at(0), b = at(1), c = at(2), p = ray.direction * hit.t;
    const float width = 0.5f * hit.t / static_cast<float>(camera_.pixels_per_x);
    const auto near_edge = [&](const Vec3f& from, const Vec3f& to) {
      return (p - from).cross(to - from).norm() < width * (to - from).norm();
    };
    return near_edge(a, b) || near_edge(b, c) || near_edge(c, a);
  }

  const DiagnosticPicture& picture_;
  const RenderScene& scene_;
  CameraFrame camera_;
  Vec3 eye_;
  EmbreeScene solids_, skin_;
  ColourMap map_;
  std::vector<Vec3f> colours_;
};

}  // namespace

ImageRgb8 draw_diagnostic(const DiagnosticPicture& picture, const RenderScene& scene) {
  check_scene(scene);
  CHECK_EQ(picture.position.size(), picture.value.size());
  const DiagnosticScene view(picture, scene);
  ImageRgb8 image{scene.camera.width, scene.camera.height, {}};
  image.pixels.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  tbb::parallel_for(tbb::blocked_range<int>(0, image.height, 4), [&](const tbb::blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y)
      for (int x = 0; x < image.width; x += 2) {
        const auto colours = view.pixels(x, y);
        for (int i = 0; i < std::min(2, image.width - x); ++i)
          image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                       static_cast<std::size_t>(x + i)] = quantize_srgb(colours[static_cast<std::size_t>(i)], 0.0f);
      }
  });
  draw_colour_bar(image, picture.scale, view.map());
  const int letter = std::max(1, image.height / 360);
  draw_text(image, 8 * letter, 8 * letter, picture.stamp, letter, {30, 30, 30});
  return image;
}

}  // namespace smelt
