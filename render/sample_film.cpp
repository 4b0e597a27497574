#include "render/sample_film.h"

#include "render/camera.h"
#include "render/integrator.h"
#include "render/sky.h"

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

constexpr int tile_size = 16;
using Tile = tbb::blocked_range2d<int>;

template <typename Body>
void for_each_tile(const Film& film, const Body& body) {
  tbb::parallel_for(Tile(0, film.height, tile_size, 0, film.width, tile_size), body, tbb::simple_partitioner());
}

/// What the ray through the middle of a pixel meets.
struct Glimpse {
  SurfaceKind kind = SurfaceKind::none;
  float fade = 0.0f;  ///< of the floor into the backdrop; 1: nothing of it shows
  Vec3f normal = Vec3f::Zero();
  Vec3f position = Vec3f::Zero();
  bool speck = false;  ///< some fluid is in the pixel, though not in its middle
};

std::vector<Glimpse> glance(const ShadingScene& scene, const CameraFrame& camera, const Film& film) {
  std::vector<Glimpse> glimpses(film.size());
  for_each_tile(film, [&](const Tile& tile) {
    for (int y = tile.rows().begin(); y < tile.rows().end(); ++y) {
      for (int x = tile.cols().begin(); x < tile.cols().end(); x += static_cast<int>(packet_size)) {
        const int n = std::min(static_cast<int>(packet_size), tile.cols().end() - x);
        RayPacket rays;
        for (int i = 0; i < n; ++i) {
          rays[static_cast<std::size_t>(i)].direction = camera.direction(x + i + 0.5, y + 0.5);
          rays[static_cast<std::size_t>(i)].active = true;
        }
        const SurfacePacket points = scene.intersect(rays, true);
        for (int i = 0; i < n; ++i) {
          const SurfacePoint& point = points[static_cast<std::size_t>(i)];
          Glimpse& glimpse = glimpses[film.index(x + i, y)];
          glimpse = {point.kind, point.fade, point.normal, point.position};
        }
      }
    }
  });
  return glimpses;
}

bool is_mesh(SurfaceKind kind) {
  return kind == SurfaceKind::fluid || kind == SurfaceKind::collider;
}

/// Drops smaller than a pixel slip between the rays through pixels' middles: where their vertices are is looked at too.
void find_specks(const ShadingScene& scene, const CameraFrame& camera, const Film& film,
                 std::vector<Glimpse>& glimpses) {
  for (const Vec3& vertex : scene.fluid().mesh.vertices) {
    const auto at = camera.project(vertex);
    if (!at || !(at->first >= 0.0 && at->first < film.width && at->second >= 0.0 && at->second < film.height)) continue;
    Glimpse& glimpse = glimpses[film.index(static_cast<int>(at->first), static_cast<int>(at->second))];
    glimpse.speck = !is_mesh(glimpse.kind);
  }
}

/// Whether two neighbouring pixels show different things, or a sharp fold of one.
bool differ(const Glimpse& a, const Glimpse& b, float pixel_angle) {
  if (!is_mesh(a.kind) && !is_mesh(b.kind)) return false;
  if (a.kind != b.kind) return true;
  if (a.normal.dot(b.normal) < 0.6f) return true;
  const Vec3f step = b.position - a.position;
  const float tolerance = 6.0f * pixel_angle * a.position.norm();
  return std::abs(a.normal.dot(step)) > tolerance && std::abs(b.normal.dot(step)) > tolerance;
}

/// A silhouette is judged by its staircase, not by its noise.
constexpr int least_silhouette_samples = 16;

/// Noise fades with the floor, so fewer samples serve there.
int plain_samples(const Glimpse& here, int samples) {
  if (here.kind == SurfaceKind::none) return 1;
  return std::max(1, static_cast<int>(std::ceil(static_cast<float>(samples) * (1.0f - here.fade))));
}

int samples_at(const std::vector<Glimpse>& glimpses, const Film& film, int x, int y, float pixel_angle, int samples) {
  const Glimpse& here = glimpses[film.index(x, y)];
  for (int j = std::max(0, y - 1); j <= std::min(film.height - 1, y + 1); ++j) {
    for (int i = std::max(0, x - 1); i <= std::min(film.width - 1, x + 1); ++i) {
      const Glimpse& beside = glimpses[film.index(i, j)];
      if (beside.speck || differ(here, beside, pixel_angle)) return std::max(samples, least_silhouette_samples);
    }
  }
  return plain_samples(here, samples);
}

/// Whether any pixel of the tile or beside it shows a mesh.
bool shows_mesh(const std::vector<Glimpse>& glimpses, const Film& film, const Tile& tile) {
  for (int y = std::max(0, tile.rows().begin() - 1); y < std::min(film.height, tile.rows().end() + 1); ++y) {
    for (int x = std::max(0, tile.cols().begin() - 1); x < std::min(film.width, tile.cols().end() + 1); ++x) {
      const Glimpse& glimpse = glimpses[film.index(x, y)];
      if (glimpse.speck || is_mesh(glimpse.kind)) return true;
    }
  }
  return false;
}

/// Sums over the samples of one pixel.
struct PixelSums {
  Vec3f light = Vec3f::Zero(), lit_albedo = Vec3f::Zero(), albedo = Vec3f::Zero(), specular = Vec3f::Zero();
  Vec3f emission = Vec3f::Zero(), normal = Vec3f::Zero(), position = Vec3f::Zero();
  Vec3f velocity = Vec3f::Zero(), colour = Vec3f::Zero();
  float alpha = 0.0f, depth = 0.0f, temperature = 0.0f, clamped = 0.0f;
  int n_deep = 0, n_warm = 0;
  float kind = 0.0f, light2 = 0.0f, specular1 = 0.0f, specular2 = 0.0f, light1 = 0.0f;

  void add(const SampleRadiance& s) {
    light += s.light;
    lit_albedo += s.albedo.cwiseProduct(s.light);
    albedo += s.albedo;
    specular += s.specular;
    emission += s.emission;
    normal += s.normal;
    position += s.position;
    kind += s.kind == SurfaceKind::fluid ? 1.0f : s.kind == SurfaceKind::collider ? 2.0f : 0.0f;
    const float l = luminance(s.light), m = luminance(s.specular);
    light1 += l;
    light2 += l * l;
    specular1 += m;
    specular2 += m * m;
    clamped += s.clamped;
  }

  void add_layers(const SampleRadiance& s, const Vec3f& forward) {
    alpha += 1.0f - s.fade;
    if (s.kind == SurfaceKind::none) return;
    depth += s.position.dot(forward);
    ++n_deep;
    velocity += s.velocity;
    colour += s.colour;
    if (std::isnan(s.temperature)) return;
    temperature += s.temperature;
    ++n_warm;
  }

  void write(Film& film, std::size_t i, int n) const {
    const float per_n = 1.0f / static_cast<float>(n);
    Vec3f mean_light = light * per_n;
    for (int c = 0; c < 3; ++c) {
      if (albedo[c] > 0.0f) mean_light[c] = lit_albedo[c] / albedo[c];
    }
    write_pixel(film.light, i, mean_light);
    write_pixel(film.albedo, i, albedo * per_n);
    write_pixel(film.specular, i, specular * per_n);
    write_pixel(film.emission, i, emission * per_n);
    write_pixel(film.normal, i, normal * per_n);
    write_pixel(film.position, i, position * per_n);
    film.kind[i] = kind * per_n;
    film.clamped[i] = clamped * per_n;
    if (film.layers) {
      film.layers->alpha[i] = alpha * per_n;
      if (n_deep > 0) film.layers->depth[i] = depth / static_cast<float>(n_deep);
      if (n_deep > 0) write_pixel(film.layers->position, i, position / static_cast<float>(n_deep));
      if (n_warm > 0) film.layers->temperature[i] = temperature / static_cast<float>(n_warm);
      write_pixel(film.layers->velocity, i, velocity * per_n);
      write_pixel(film.layers->colour, i, colour * per_n);
    }
    // One sample knows nothing of its error: as uncertain as it is bright.
    const auto variance = [n, per_n](float sum, float sum2) {
      if (n == 1) return sum * sum;
      return std::max(0.0f, sum2 - sum * sum * per_n) * per_n / static_cast<float>(n - 1);
    };
    film.light_variance[i] = variance(light1, light2);
    film.specular_variance[i] = variance(specular1, specular2);
  }
};

/// The samples of one tile, traced packet by packet in a fixed order.
class TileTracer {
 public:
  TileTracer(const ShadingScene& scene, const CameraFrame& camera, const RenderOptions& options, std::uint32_t seed)
      : scene_(scene),
        camera_(camera),
        options_(options),
        path_{options.bounces, options.firefly_limit, options.samples < least_silhouette_samples},
        blurred_(scene.view().camera.aperture > 0.0 || scene.view().camera.shutter > 0.0),
        seed_(seed) {}

  /// `meshes`: whether any mesh can be in the pixel.
  void add_pixel(std::size_t index, int x, int y, int n_samples, bool meshes) {
    pixels_.push_back({index, n_samples, {}});
    for (int s = 0; s < n_samples; ++s) {
      CameraSample sample;
      sample.sampler = PixelSampler(x, y, s, n_samples, seed_);
      const Sample2 place = n_samples == 1 ? Sample2{0.5f, 0.5f} : sample.sampler.draw(dim_pixel);
      sample.direction = camera_.direction(x + static_cast<double>(place.u), y + static_cast<double>(place.v));
      if (blurred_) {
        const auto ray = camera_.through_lens(sample.direction, sample.sampler.draw(dim_lens));
        sample.origin = ray.origin;
        sample.direction = ray.direction;
        sample.time = sample.sampler.draw(dim_time).u;
      }
      sample.meshes = meshes;
      packet_[n_waiting_] = sample;
      owner_[n_waiting_] = pixels_.size() - 1;
      if (++n_waiting_ == packet_size) flush();
    }
  }

  void write(Film& film) {
    flush();
    for (const Pixel& pixel : pixels_) pixel.sums.write(film, pixel.index, pixel.n_samples);
  }

 private:
  struct Pixel {
    std::size_t index;
    int n_samples;
    PixelSums sums;
  };

  void flush() {
    if (n_waiting_ == 0) return;
    const auto seen = trace_packet(scene_, std::span(packet_).first(n_waiting_), path_);
    for (std::size_t i = 0; i < n_waiting_; ++i) {
      pixels_[owner_[i]].sums.add(seen[i]);
      if (options_.layers) pixels_[owner_[i]].sums.add_layers(seen[i], camera_.forward.cast<float>());
    }
    n_waiting_ = 0;
  }

  const ShadingScene& scene_;
  const CameraFrame& camera_;
  const RenderOptions& options_;
  PathOptions path_;
  bool blurred_;  ///< by lens or motion
  std::uint32_t seed_;
  std::vector<Pixel> pixels_;
  std::array<CameraSample, packet_size> packet_;
  std::array<std::size_t, packet_size> owner_{};
  std::size_t n_waiting_ = 0;
};

}  // namespace

Film sample_film(const ShadingScene& scene, const RenderOptions& options, std::int32_t frame) {
  const CameraFrame camera(scene.view().camera);
  Film film(scene.view().camera.width, scene.view().camera.height, options.layers);
  std::vector<Glimpse> glimpses = glance(scene, camera, film);
  find_specks(scene, camera, film, glimpses);
  const float pixel_angle = 1.0f / static_cast<float>(camera.pixels_per_x);
  const std::uint32_t seed =
      options.moving_noise ? hash_combine(options.seed, static_cast<std::uint32_t>(frame)) : hash_u32(options.seed);
  // Out of focus or moving, things show where a sharp ray through the pixel misses them.
  const bool blurred = scene.view().camera.aperture > 0.0 || scene.view().camera.shutter > 0.0;
  for_each_tile(film, [&](const Tile& tile) {
    TileTracer tracer(scene, camera, options, seed);
    const bool any_mesh = blurred || shows_mesh(glimpses, film, tile);
    for (int y = tile.rows().begin(); y < tile.rows().end(); ++y) {
      for (int x = tile.cols().begin(); x < tile.cols().end(); ++x) {
        const std::size_t i = film.index(x, y);
        const Glimpse& seen = glimpses[i];
        const bool bare = seen.kind == SurfaceKind::none || seen.fade >= 1.0f;
        if (!any_mesh && bare) {
          write_pixel(film.emission, i, scene.background(camera.direction(x + 0.5, y + 0.5)));
        } else {
          const int n = blurred    ? options.samples
                        : any_mesh ? samples_at(glimpses, film, x, y, pixel_angle, options.samples)
                                   : plain_samples(seen, options.samples);
          tracer.add_pixel(i, x, y, n, any_mesh);
        }
      }
    }
    tracer.write(film);
  });
  return film;
}

}  // namespace smelt
