#include "bench/cases/surfacing.h"

#include "bench/bench_folder.h"
#include "bench/cases/cpu_clock.h"
#include "core/geometry/seeding.h"
#include "io/mesh_import.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>

namespace smelt::surfacing_cases {

namespace {

enum class Quantity { volume, distance, normals };

struct Method {
  bool anisotropic;
  Quantity quantity;
};
constexpr std::array sphere_methods{Method{true, Quantity::volume},    Method{true, Quantity::distance},
                                    Method{true, Quantity::normals},   Method{false, Quantity::volume},
                                    Method{false, Quantity::distance}, Method{false, Quantity::normals}};

Measurement run_sphere(std::size_t method, double across) {
  const auto [anisotropic, quantity] = sphere_methods[method];
  ParticleFrame frame = make_ball(1.0, 2.0 / across);
  jitter(frame, 0.1);
  const CpuClock clock;
  const SurfaceMesh surface = build_surface(frame, with_kernels(anisotropic));
  const double seconds = clock.seconds();
  const BallErrors errors = measure_ball(surface, frame, 1.0);
  return {.error = quantity == Quantity::volume     ? std::abs(errors.volume)
                   : quantity == Quantity::distance ? errors.farthest
                                                    : errors.normals,
          .cpu_seconds = seconds,
          .n_particles = frame.size()};
}

constexpr std::array bunny_methods{Method{true, Quantity::volume}, Method{true, Quantity::distance},
                                   Method{false, Quantity::volume}, Method{false, Quantity::distance}};

Measurement run_bunny(std::size_t method, double across) {
  const auto [anisotropic, quantity] = bunny_methods[method];
  const TriangleMesh bunny = import_mesh(bench_folder().parent_path() / "assets" / "bunny.obj");
  const Box3 bounds = compute_bounds(bunny);
  const double height = bounds.upper.y() - bounds.lower.y();
  SeedingOptions seeding;
  seeding.spacing = height / across;
  const Seeds seeds = seed_particles(bunny, seeding);
  const CpuClock clock;
  const SurfaceMesh surface = build_surface(make_frame(seeds.positions, seeds.spacing), with_kernels(anisotropic));
  Measurement measured{.cpu_seconds = clock.seconds(), .n_particles = seeds.positions.size()};
  if (quantity == Quantity::volume) {
    measured.error = std::abs(compute_volume(surface.mesh) / seeds.volume - 1.0);
  } else {
    const double limit = 8.0 * seeds.spacing;
    measured.error =
        std::max(distances(surface.mesh, bunny, limit).largest, distances(bunny, surface.mesh, limit).largest) / height;
  }
  return measured;
}

}  // namespace

ParticleFrame make_frame(std::vector<Vec3> position, double spacing) {
  ParticleFrame frame;
  frame.velocity.assign(position.size(), Vec3f::Zero());
  frame.density.assign(position.size(), 1000.0f);
  frame.position = std::move(position);
  frame.mass = 1000.0 * spacing * spacing * spacing;
  frame.spacing = spacing;
  return frame;
}

void jitter(ParticleFrame& frame, double most) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-most * frame.spacing, most * frame.spacing);
  for (Vec3& x : frame.position) x += Vec3(uniform(random), uniform(random), uniform(random));
}

ParticleFrame make_ball(double radius, double spacing) {
  std::vector<Vec3> position;
  const double n = std::ceil(radius / spacing) + 1;
  for (double k = -n; k <= n; ++k)
    for (double j = -n; j <= n; ++j)
      for (double i = -n; i <= n; ++i)
        if (const Vec3 x = spacing * Vec3(i + 0.2, j + 0.3, k + 0.1); x.norm() < radius) position.push_back(x);
  return make_frame(std::move(position), spacing);
}

SurfacingOptions with_kernels(bool anisotropic) {
  SurfacingOptions options;
  options.anisotropic = anisotropic;
  return options;
}

std::vector<Simplex<3>> simplices(const TriangleMesh& mesh) {
  std::vector<Simplex<3>> out;
  for (const auto& t : mesh.triangles) out.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
  return out;
}

BallErrors measure_ball(const SurfaceMesh& surface, const ParticleFrame& frame, double radius) {
  BallErrors errors;
  const auto n = static_cast<double>(surface.normals.size());
  for (std::size_t v = 0; v < surface.normals.size(); ++v) {
    const Vec3& x = surface.mesh.vertices[v];
    errors.mean_radius += x.norm() / n;
    errors.farthest = std::max(errors.farthest, std::abs(x.norm() / radius - 1.0));
    errors.normals += std::pow(std::acos(std::min(1.0, surface.normals[v].cast<double>().dot(x.normalized()))), 2) / n;
  }
  errors.mean_radius = errors.mean_radius / radius - 1.0;
  errors.normals = std::sqrt(errors.normals);
  errors.volume = compute_volume(surface.mesh) / (static_cast<double>(frame.size()) * std::pow(frame.spacing, 3)) - 1.0;
  return errors;
}

Distances distances(const TriangleMesh& from, const TriangleMesh& to, double limit) {
  const SimplexBvh<3> nearest(simplices(to));
  Distances out;
  double area = 0.0;
  for (const auto& t : from.triangles) {
    const Vec3 &a = from.vertices[t[0]], &b = from.vertices[t[1]], &c = from.vertices[t[2]];
    const double of_face = 0.5 * (b - a).cross(c - a).norm();
    for (const Vec3& x : {a, b, c, Vec3((a + b + c) / 3.0)}) {
      const double d = nearest.distance(x, limit);
      out.largest = std::max(out.largest, d);
      out.mean += 0.25 * of_face * d;
    }
    area += of_face;
  }
  out.mean /= area;
  return out;
}

Case make_sphere_case() {
  return {
      .name = "surface_sphere",
      .title = "Surface of a ball of particles",
      .measures =
          "What the surface of a ball of shaken particles (0.1 spacings) is off in volume, in the farthest distance "
          "from the sphere over the radius, and in its normals (root mean square angle), with kernels that are "
          "flattened at the surface and with round ones.",
      .good = "Volume within 0.5 %, distance within 1 %, normals within 0.05 rad (3 degrees), 27 particles across.",
      .good_errors = {0.005, 0.01, 0.05, 0.005, 0.01, 0.05},
      .error_label = "error, relative or rad",
      .resolution_label = "particles across the ball",
      .methods = {"volume", "distance", "normals", "volume, round", "distance, round", "normals, round"},
      .quick = {10, 20, 40},
      .full = {10, 20, 40, 80},
      .run = run_sphere};
}

Case make_bunny_case() {
  return {
      .name = "surface_bunny",
      .title = "Surface of the bunny's particles",
      .measures =
          "What the surface of the particles that fill the Stanford bunny is off its mesh: in volume, and in "
          "Hausdorff's distance over the bunny's height, with kernels that are flattened at the surface and with round "
          "ones.",
      .good = "Volume within 1 %, distance within a spacing of the particles: 2.5 % of the height at 40.",
      .good_errors = {0.01, 0.025, 0.01, 0.025},
      .error_label = "error, relative",
      .resolution_label = "particles in the height",
      .methods = {"volume", "distance", "volume, round", "distance, round"},
      .quick = {20, 30, 40},
      .full = {20, 30, 40, 60, 80},
      .run = run_bunny};
}

}  // namespace smelt::surfacing_cases
