// Containers that hold what is shaken in them, and spheres that rest for long. The whole size, 10^5 spheres for 10^4
// steps, is bench_containers.

#include "tests/stability/containers.h"

#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace smelt {
namespace {

void test_container(const Container& container) {
  // A step of fifty radii passes thousands of the dragon's triangles.
  const bool fine = container.facets.size() > 10000;
  ShakeOptions options;
  options.n_particles = full_run() ? (fine ? 150 : 1000) : (fine ? 40 : 100);
  options.n_steps = full_run() ? (fine ? 300 : 1000) : (fine ? 100 : 300);
  const Shaken seen = shake(container, options);
  const std::string problem = fmt::format("spheres shaken in a container; {}", container.name);
  const std::string resolution = fmt::format("{} spheres {} steps", options.n_particles, options.n_steps);
  report_row({problem, "spheres lost", resolution, static_cast<double>(seen.n_lost), 0.0});
  report_row({problem, "deepest in a facet / radius", resolution, seen.deepest, 1e-6});
  EXPECT_GT(seen.hits, 0.02) << "hardly anything was hit";
  EXPECT_GT(seen.way, 0.1) << "they hardly move";
}

TEST(Containers, Box) {
  test_container(make_closed_box());
}
TEST(Containers, Funnel) {
  test_container(make_funnel());
}
TEST(Containers, Sieve) {
  test_container(make_sieve());
}
TEST(Containers, Bowl) {
  test_container(make_bowl());
}
TEST(Containers, Dragon) {
  test_container(make_dragon());
}

// On a floor, in an edge, in a corner and in the tip of a funnel, pressed down by gravity. A million steps take
// minutes; fewer do for every day.
TEST(Containers, RestingSpheresStayWhereTheyAre) {
  const int n_steps = full_run() ? 1000000 : 5000;
  const Container box = make_closed_box(), funnel = make_funnel();
  const auto rest = [&](const Container& container, Vec3 position, const ContactResponse& response) {
    Colliders<3> colliders;
    Obstacle<3> vessel;
    vessel.facets = container.facets;
    vessel.response = response;
    colliders.add(vessel);
    const SimplexBvh<3> bvh(container.facets);
    Vec3 velocity = Vec3::Zero();
    double moved = 0.0, deepest = 0.0;
    Vec3 start = position;
    for (int step = 1; step <= n_steps; ++step) {
      velocity[1] -= 1e-3 * container.radius;
      Vec3 transport = velocity;
      colliders.move_sphere(container.radius, 1.0, position, transport, velocity);
      if (step == n_steps / 10) start = position;
      if (step > n_steps / 10) moved = std::max(moved, (position - start).norm());
      if (step % 100 != 0) continue;
      std::vector<std::uint32_t> found;
      bvh.find_near(position, container.radius, found);
      for (const std::uint32_t f : found)
        deepest = std::max(
            deepest, 1.0 - (position - closest_point<3>(position, container.facets[f])).norm() / container.radius);
    }
    EXPECT_LT(deepest, 1e-9) << container.name;
    EXPECT_LT(moved, 1e-9) << container.name << " restitution " << response.restitution << " friction "
                           << response.friction;
  };
  for (const ContactResponse& response : {ContactResponse{0.0, 0.0}, ContactResponse{1.0, 0.0}}) {
    rest(box, Vec3(0.1, -0.5 + box.radius, 0.2), response);
    rest(box, Vec3(0.1, -0.5 + box.radius, 0.5 - box.radius), response);
    rest(box, Vec3::Constant(-0.5 + box.radius), response);
    rest(funnel, Vec3(0.0, 0.1, 0.0), response);
  }
}

}  // namespace
}  // namespace smelt
