#include "tests/stability/containers.h"

#include "core/error.h"
#include "core/geometry/inside.h"
#include "core/geometry/repair.h"
#include "core/parallel.h"
#include "tests/meshes.h"

#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>

namespace smelt {

namespace {

constexpr double pi = std::numbers::pi;

std::vector<Simplex<3>> facets_of(const TriangleMesh& mesh) {
  std::vector<Simplex<3>> facets;
  for (const auto& t : mesh.triangles)
    facets.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
  return facets;
}

void add_quad(std::vector<Simplex<3>>& facets, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  facets.push_back({a, b, c});
  facets.push_back({a, c, d});
}

/// A surface of revolution about y from `lower` to `upper` (distance from the axis, height), in `n` sides.
void add_ring(std::vector<Simplex<3>>& facets, const Vec<2>& lower, const Vec<2>& upper, int n) {
  const auto at = [&](const Vec<2>& p, int k) {
    const double angle = 2.0 * pi * k / n;
    return Vec3(p[0] * std::cos(angle), p[1], p[0] * std::sin(angle));
  };
  for (int k = 0; k < n; ++k) {
    if (lower[0] > 0.0) facets.push_back({at(lower, k), at(upper, k), at(lower, (k + 1) % n)});
    if (upper[0] > 0.0) facets.push_back({at(upper, k), at(upper, (k + 1) % n), at(lower, (k + 1) % n)});
  }
}

}  // namespace

Container make_closed_box() {
  Container c{"box",
              facets_of(make_box(Vec3::Constant(-0.5), Vec3::Constant(0.5))),
              {Vec3::Constant(-0.5), Vec3::Constant(0.5)},
              0.01};
  c.contains = [](const Vec3& x) { return x.cwiseAbs().maxCoeff() < 0.5; };
  return c;
}

Container make_funnel() {
  constexpr int n = 48;
  Container c{"funnel", {}, {Vec3(-0.5, 0.05, -0.5), Vec3(0.5, 1.0, 0.5)}, 0.01};
  const double hole = 0.9 * c.radius;
  add_ring(c.facets, {hole, 0.0}, {0.5, 0.6}, n);
  add_ring(c.facets, {0.5, 0.6}, {0.5, 1.0}, n);
  add_ring(c.facets, {0.5, 1.0}, {0.0, 1.0}, n);
  c.contains = [=](const Vec3& x) {
    const double from_axis = std::hypot(x[0], x[2]);
    // A centre may stand in the hole, by less than what its sphere spans there.
    return x[1] > -0.2 * hole && x[1] < 1.0 && from_axis < 0.5 &&
           from_axis < hole + (0.5 - hole) * std::max(x[1], 0.0) / 0.6;
  };
  return c;
}

Container make_sieve() {
  Container c{"sieve", {}, {Vec3(-0.25, 0.0, -0.25), Vec3(0.25, 0.5, 0.25)}, 0.01};
  const double hole = 1.8 * c.radius, strip = 0.7 * c.radius;
  const int n = static_cast<int>(std::ceil(0.5 / (hole + strip)));
  const double half = 0.5 * (n * (hole + strip) + strip), pitch = hole + strip;
  c.bounds = {Vec3(-half, 0.0, -half), Vec3(half, 0.5, half)};
  for (int i = 0; i <= n; ++i) {
    const double from = -half + i * pitch, to = from + strip;
    // Long strips one way; between them short ones, whose corners stand in the middle of the long ones' sides.
    add_quad(c.facets, {from, 0, -half}, {from, 0, half}, {to, 0, half}, {to, 0, -half});
    if (i == n) break;
    for (int k = 0; k <= n; ++k) {
      const double low = -half + k * pitch, high = low + strip;
      add_quad(c.facets, {to, 0, low}, {to, 0, high}, {to + hole, 0, high}, {to + hole, 0, low});
    }
  }
  const double top = 0.5;
  add_quad(c.facets, {-half, top, -half}, {half, top, -half}, {half, top, half}, {-half, top, half});
  for (int axis : {0, 2})
    for (const double side : {-half, half}) {
      const auto at = [&](double u, double y) {
        Vec3 p(u, y, u);
        p[axis] = side;
        return p;
      };
      add_quad(c.facets, at(-half, 0), at(half, 0), at(half, top), at(-half, top));
    }
  c.contains = [=](const Vec3& x) {
    return x[1] > 0.0 && x[1] < top && std::max(std::abs(x[0]), std::abs(x[2])) < half;
  };
  return c;
}

Container make_bowl() {
  constexpr int n_rings = 16, n = 48;
  Container c{"bowl", {}, {Vec3(-0.5, -0.5, -0.5), Vec3(0.5, 0.0, 0.5)}, 0.01};
  const auto on_ball = [](int k) {
    return Vec<2>(0.5 * std::sin(0.5 * pi * k / n_rings), -0.5 * std::cos(0.5 * pi * k / n_rings));
  };
  for (int k = 0; k < n_rings; ++k) add_ring(c.facets, k == 0 ? Vec<2>(0.0, -0.5) : on_ball(k), on_ball(k + 1), n);
  add_ring(c.facets, {0.5, 0.0}, {0.0, 0.0}, n);
  c.contains = [](const Vec3& x) { return x.norm() < 0.5 && x[1] < 1e-9; };
  return c;
}

Container make_dragon() {
  const auto mesh = std::make_shared<TriangleMesh>(load_asset("dragon.obj"));
  CHECK(compute_topology(*mesh).closed());
  const Box3 bounds = compute_bounds(*mesh);
  Container c{"dragon", facets_of(*mesh), {bounds.lower, bounds.upper}, 0.005 * bounds.extent().maxCoeff()};
  const auto inside = std::make_shared<InsideTest>(*mesh, bounds.extent().maxCoeff() / 200.0);
  c.contains = [mesh, inside](const Vec3& x) {
    thread_local std::vector<Crossing> crossings;
    return inside->contains(x, crossings);
  };
  return c;
}

namespace {

struct Ball {
  Vec3 position, velocity;  ///< [m], [m a step]
  std::mt19937_64 random;
};

constexpr std::array<ContactResponse, 5> responses{{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.5, 0.5}, {0.9, 0.95}}};

double uniform(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

Vec3 random_direction(std::mt19937_64& random) {
  const double z = 2.0 * uniform(random) - 1.0, angle = 2.0 * pi * uniform(random), across = std::sqrt(1.0 - z * z);
  return {across * std::cos(angle), across * std::sin(angle), z};
}

/// How deep it is in the nearest facet, in radii.
double depth_of(const SimplexBvh<3>& bvh, const Vec3& x, double radius, std::vector<std::uint32_t>& found) {
  found.clear();
  bvh.find_near(x, radius, found);
  double nearest = radius;
  for (const std::uint32_t f : found) nearest = std::min(nearest, (x - closest_point<3>(x, bvh.simplices()[f])).norm());
  return 1.0 - nearest / radius;
}

/// In the container and clear of it.
Ball place_ball(const Container& c, const SimplexBvh<3>& bvh, std::uint64_t seed) {
  Ball ball{Vec3::Zero(), Vec3::Zero(), std::mt19937_64(seed)};
  std::vector<std::uint32_t> found;
  do {
    for (int a = 0; a < 3; ++a) ball.position[a] = c.bounds.lower[a] + uniform(ball.random) * c.bounds.extent()[a];
  } while (!c.contains(ball.position) || depth_of(bvh, ball.position, c.radius, found) > 0.0);
  return ball;
}

/// A step of gravity, now and then a kick: up to fifty radii a step, more often a few.
void drive(Ball& ball, double radius) {
  ball.velocity[1] -= 0.02 * radius;
  if (ball.random() % 50 == 0) {
    const double strength = uniform(ball.random);
    ball.velocity += 50.0 * radius * strength * strength * strength * random_direction(ball.random);
  }
  const double speed = ball.velocity.norm();
  if (speed > 50.0 * radius) ball.velocity *= 50.0 * radius / speed;
}

}  // namespace

Shaken shake(const Container& container, const ShakeOptions& options) {
  const SimplexBvh<3> bvh(container.facets);
  std::vector<Colliders<3>> colliders(responses.size());
  for (std::size_t k = 0; k < responses.size(); ++k) {
    Obstacle<3> vessel;
    vessel.facets = container.facets;
    vessel.response = responses[k];
    colliders[k].add(std::move(vessel));
  }
  struct Watch {
    std::size_t n_lost = 0;
    double deepest = 0.0, way = 0.0, seconds = 0.0;
    std::size_t n_hits = 0;
  };
  const auto n = static_cast<std::size_t>(options.n_particles);
  const Watch watch = deterministic_reduce(
      n, Watch{},
      [&](std::size_t i) {
        Watch seen;
        std::vector<std::uint32_t> found;
        Ball ball = place_ball(container, bvh, options.seed * 1000003 + i);
        const Colliders<3>& vessel = colliders[i % colliders.size()];
        const auto start = std::chrono::steady_clock::now();
        for (int step = 1; step <= options.n_steps; ++step) {
          drive(ball, container.radius);
          const Vec3 before = ball.position;
          Vec3 transport = ball.velocity;
          seen.n_hits += vessel.move_sphere(container.radius, 1.0, ball.position, transport, ball.velocity);
          seen.way += (ball.position - before).norm();
          if (step % options.check_every != 0 && step != options.n_steps) continue;
          seen.deepest = std::max(seen.deepest, depth_of(bvh, ball.position, container.radius, found));
          if (container.contains(ball.position)) continue;
          seen.n_lost = 1;
          break;
        }
        seen.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        return seen;
      },
      [](const Watch& a, const Watch& b) {
        return Watch{a.n_lost + b.n_lost, std::max(a.deepest, b.deepest), a.way + b.way, a.seconds + b.seconds,
                     a.n_hits + b.n_hits};
      });
  const double n_moves = static_cast<double>(n) * options.n_steps;
  return {n,
          watch.n_lost,
          watch.deepest,
          static_cast<double>(watch.n_hits) / n_moves,
          watch.way / n_moves / container.radius,
          watch.seconds};
}

}  // namespace smelt
