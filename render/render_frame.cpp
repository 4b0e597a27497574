#include "render/render_frame.h"

#include "core/error.h"
#include "render/camera.h"
#include "render/denoise.h"
#include "render/sample_film.h"
#include "render/shading_scene.h"
#include "render/tone_map.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>

namespace smelt {

namespace {

void check_surface(const SurfaceMesh& fluid) {
  const std::size_t n = fluid.mesh.vertices.size();
  const auto check_count = [n](const char* what, std::size_t count) {
    if (count != 0 && count != n) fail("surface: {} {} for {} vertices; give one per vertex or none", count, what, n);
  };
  check_count("normals", fluid.normals.size());
  check_count("temperatures", fluid.temperature.size());
  for (std::size_t i = 0; i < n; ++i) {
    if (!fluid.mesh.vertices[i].allFinite())
      fail("surface: vertex {} is not finite; every coordinate must be a number", i);
  }
  for (std::size_t i = 0; i < fluid.mesh.triangles.size(); ++i) {
    for (const std::uint32_t index : fluid.mesh.triangles[i]) {
      if (index >= n) fail("surface: triangle {} uses vertex {}, but there are {}; the file is damaged", i, index, n);
    }
  }
}

void check_options(const RenderOptions& options) {
  if (options.samples < 1 || options.samples > 4096) {
    fail("render: {} samples a pixel; choose 1 to 4096", options.samples);
  }
}

/// A camera in the fluid sees the backs of its triangles on most sides.
void check_eye_outside(const ShadingScene& scene) {
  RayPacket rays;
  for (std::size_t i = 0; i < 6; ++i) {
    rays[i].direction = Vec3f::Constant(0.05f);  // off the axes, along which symmetric meshes have their seams
    rays[i].direction[static_cast<int>(i / 2)] = i % 2 == 0 ? 1.0f : -1.0f;
    rays[i].direction.normalize();
    rays[i].active = true;
  }
  const HitPacket hits = scene.intersect_meshes(rays);
  int n_backs = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    if (hits[i].geometry != 0) continue;
    n_backs += hits[i].normal.dot(rays[i].direction) > 0.0f ? 1 : 0;
  }
  if (n_backs < 4) return;
  const Vec3& eye = scene.origin();
  fail("camera.eye: ({:.3g}, {:.3g}, {:.3g}) is inside the fluid; move it out", eye.x(), eye.y(), eye.z());
}

ImageRgb8 develop(const Film& film, double exposure) {
  ImageRgb8 image{film.width, film.height, {}};
  image.pixels.resize(film.size());
  const auto gain = static_cast<float>(exposure);
  const auto width = static_cast<std::size_t>(film.width);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, film.size(), 8192),
                    [&](const tbb::blocked_range<std::size_t>& pixels) {
                      for (std::size_t i = pixels.begin(); i < pixels.end(); ++i) {
                        const Vec3f radiance = read_pixel(film.albedo, i).cwiseProduct(read_pixel(film.light, i)) +
                                               read_pixel(film.specular, i) + read_pixel(film.emission, i);
                        const PixelSampler random(static_cast<int>(i % width), static_cast<int>(i / width), 0, 1, 0);
                        const Sample2 s = random.draw(0);
                        image.pixels[i] = quantize_srgb(tone_map_neutral(radiance * gain), s.u + s.v - 1.0f);
                      }
                    });
  return image;
}

}  // namespace

ImageRgb8 render_frame(const SurfaceMesh& fluid, const RenderScene& scene, const RenderOptions& options,
                       std::int32_t frame) {
  check_scene(scene);
  check_options(options);
  check_surface(fluid);
  const ShadingScene shading(fluid, scene);
  check_eye_outside(shading);
  Film film = sample_film(shading, options, frame);
  if (options.denoise) {
    const auto pixels_per_radian = static_cast<float>(CameraFrame(scene.camera).pixels_per_x);
    denoise(film.light, film.light_variance, film, film.albedo[1], pixels_per_radian, {});
    // Reflections turn twice as fast as the surface, and their edges are what makes it look wet.
    const DenoiseOptions sharp{.n_levels = 4, .luminance_sigmas = 4.0f, .normal_width = 0.15f};
    denoise(film.specular, film.specular_variance, film, film.kind, pixels_per_radian, sharp);
  }
  return develop(film, scene.exposure);
}

}  // namespace smelt
