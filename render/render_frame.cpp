#include "render/render_frame.h"

#include "core/error.h"
#include "render/camera.h"
#include "render/denoise.h"
#include "render/sample_film.h"
#include "render/shading_scene.h"
#include "render/tone_map.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace smelt {

namespace {

void check_surface(const SurfaceMesh& fluid) {
  const std::size_t n = fluid.mesh.vertices.size();
  const auto check_count = [n](const char* what, std::size_t count) {
    if (count != 0 && count != n) fail("surface: {} {} for {} vertices; give one per vertex or none", count, what, n);
  };
  check_count("normals", fluid.normals.size());
  check_count("temperatures", fluid.temperature.size());
  check_count("rest positions", fluid.rest.size());
  check_count("velocities", fluid.velocity.size());
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

/// What the look wants to know of the surface.
void check_attributes(const SurfaceMesh& fluid, const Look& look) {
  if (fluid.mesh.vertices.empty()) return;
  if (look.black_body && fluid.temperature.empty())
    fail("look.black_body: the surface has no temperature to glow with; give the material `heat`, or leave this out");
  if (look.crust && fluid.rest.empty())
    fail(
        "look.crust: the surface has no rest positions, which its pattern moves with; set particles.rest_position = "
        "true and simulate again, or leave this out");
}

void check_options(const RenderOptions& options) {
  if (options.samples < 1 || options.samples > 4096) {
    fail("render: {} samples a pixel; choose 1 to 4096", options.samples);
  }
  if (options.bounces < 1 || options.bounces > 24) fail("render: {} bounces; choose 1 to 24", options.bounces);
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
  fail("camera.eye_m: ({:.3g}, {:.3g}, {:.3g}) is inside the fluid; move it out", eye.x(), eye.y(), eye.z());
}

/// Tone-maps every pixel; `quantize(display colour, x, y)` makes its numbers.
template <typename Channel, typename Quantize>
ImageRgb<Channel> develop(const Film& film, double exposure, ToneCurve curve, const Quantize& quantize) {
  ImageRgb<Channel> image{film.width, film.height, {}};
  image.pixels.resize(film.size());
  const auto gain = static_cast<float>(exposure);
  const auto width = static_cast<std::size_t>(film.width);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, film.size(), 8192), [&](const tbb::blocked_range<std::size_t>& pixels) {
        for (std::size_t i = pixels.begin(); i < pixels.end(); ++i) {
          const Vec3f exposed = radiance_at(film, i) * gain;
          const Vec3f shown = curve == ToneCurve::film ? tone_map_film(exposed) : tone_map_neutral(exposed);
          image.pixels[i] = quantize(shown, static_cast<int>(i % width), static_cast<int>(i / width));
        }
      });
  return image;
}

}  // namespace

Vec3f radiance_at(const Film& film, std::size_t pixel) {
  return read_pixel(film.albedo, pixel).cwiseProduct(read_pixel(film.light, pixel)) + read_pixel(film.specular, pixel) +
         read_pixel(film.emission, pixel);
}

ImageRgb8 develop8(const Film& film, double exposure, ToneCurve curve) {
  return develop<std::uint8_t>(film, exposure, curve, [](const Vec3f& colour, int x, int y) {
    const Sample2 s = PixelSampler(x, y, 0, 1, 0).draw(0);
    return quantize_srgb(colour, s.u + s.v - 1.0f);
  });
}

ImageRgb16 develop16(const Film& film, double exposure, ToneCurve curve) {
  return develop<std::uint16_t>(film, exposure, curve,
                                [](const Vec3f& colour, int, int) { return quantize_srgb16(colour); });
}

LayeredImage to_layers(const Film& film, const Vec3& eye) {
  CHECK(film.layers.has_value());
  LayeredImage image{film.width, film.height, {}};
  const auto add = [&](const char* name, const auto& value_of) {
    ImageChannel& channel = image.channels.emplace_back(ImageChannel{name, std::vector<float>(film.size())});
    for (std::size_t i = 0; i < film.size(); ++i) channel.values[i] = value_of(i);
  };
  const auto plane = [](const Plane& values) { return [&values](std::size_t i) { return values[i]; }; };
  for (int c = 0; c < 3; ++c)
    add(c == 0 ? "R" : c == 1 ? "G" : "B", [&](std::size_t i) { return radiance_at(film, i)[c]; });
  add("A", plane(film.layers->alpha));
  const auto add_colour = [&](const char* r, const char* g, const char* b, const Plane3& planes) {
    add(r, plane(planes[0]));
    add(g, plane(planes[1]));
    add(b, plane(planes[2]));
  };
  add_colour("albedo.R", "albedo.G", "albedo.B", film.layers->colour);
  add("depth.Z", plane(film.layers->depth));
  add_colour("normal.X", "normal.Y", "normal.Z", film.normal);
  for (std::size_t a = 0; a < 3; ++a)
    add(a == 0   ? "position.X"
        : a == 1 ? "position.Y"
                 : "position.Z",
        [&](std::size_t i) {
          const bool there = film.layers->depth[i] != 0.0f;
          return there ? static_cast<float>(film.layers->position[a][i] + eye[static_cast<int>(a)]) : 0.0f;
        });
  add("temperature.T", plane(film.layers->temperature));
  add_colour("velocity.X", "velocity.Y", "velocity.Z", film.layers->velocity);
  return image;
}

double clamped_share(const Film& film) {
  double taken = 0.0, left = 0.0;
  for (std::size_t i = 0; i < film.size(); ++i) {
    taken += film.clamped[i];
    left += luminance(radiance_at(film, i));
  }
  return taken > 0.0 ? taken / (taken + left) : 0.0;
}

Film render_film(const SurfaceMesh& fluid, const RenderScene& scene, const RenderOptions& options, std::int32_t frame) {
  check_scene(scene);
  check_options(options);
  check_surface(fluid);
  check_attributes(fluid, scene.look);
  const ShadingScene shading(fluid, scene);
  check_eye_outside(shading);
  // The limit is meant as displayed.
  RenderOptions exposed = options;
  exposed.firefly_limit = options.firefly_limit / static_cast<float>(scene.exposure);
  Film film = sample_film(shading, exposed, frame);
  if (options.denoise) {
    const auto pixels_per_radian = static_cast<float>(CameraFrame(scene.camera).pixels_per_x);
    Plane coloured(film.size());  // where the body shows anything, of whichever colour
    for (std::size_t i = 0; i < coloured.size(); ++i)
      coloured[i] = std::max({film.albedo[0][i], film.albedo[1][i], film.albedo[2][i]});
    denoise(film.light, film.light_variance, film, coloured, pixels_per_radian, {});
    // Reflections turn twice as fast as the surface, and their edges are what makes it look wet.
    const DenoiseOptions sharp{.n_levels = 4, .luminance_sigmas = 4.0f, .normal_width = 0.15f};
    denoise(film.specular, film.specular_variance, film, film.kind, pixels_per_radian, sharp);
  }
  return film;
}

ImageRgb8 render_frame(const SurfaceMesh& fluid, const RenderScene& scene, const RenderOptions& options,
                       std::int32_t frame) {
  return develop8(render_film(fluid, scene, options, frame), scene.exposure);
}

}  // namespace smelt
