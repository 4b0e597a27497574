#include "render/embree_scene.h"

#include "tests/render/test_meshes.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace smelt {
namespace {

Ray ray_along(const Vec3f& origin, const Vec3f& direction) {
  Ray ray;
  ray.origin = origin;
  ray.direction = direction;
  ray.active = true;
  return ray;
}

TEST(EmbreeScene, HitsWhatItShould) {
  EmbreeScene scene;
  const Vec3 origin(100.0, 0.0, 0.0);
  EXPECT_EQ(scene.add_mesh({}, origin), 0);
  EXPECT_EQ(scene.add_mesh(test::make_quad(Vec3(99, -1, 2), Vec3(2, 0, 0), Vec3(0, 2, 0)), origin), 1);
  scene.commit();
  RayPacket rays;
  rays[0] = ray_along(Vec3f(0.3f, 0.1f, 0.0f), Vec3f(0, 0, 1));
  rays[1] = ray_along(Vec3f(1.3f, 0.1f, 0.0f), Vec3f(0, 0, 1));
  rays[2] = rays[0];
  rays[2].t_far = 1.9f;
  rays[3] = rays[0];
  rays[3].active = false;
  rays[4] = rays[0];
  rays[4].meshes = false;
  const HitPacket hits = scene.intersect(rays);
  EXPECT_EQ(hits[0].geometry, 1);
  EXPECT_NEAR(hits[0].t, 2.0f, 1e-6f);
  EXPECT_GT(hits[0].normal.z(), 0.0f);  // by the winding, not towards the ray
  const auto blocked = scene.occluded(rays);
  EXPECT_TRUE(blocked[0]);
  for (std::size_t i = 1; i < packet_size; ++i) {
    EXPECT_EQ(hits[i].geometry, -1) << i;
    EXPECT_FALSE(blocked[i]) << i;
  }
}

/// Embree's own thread limit would hold all of oneTBB, and everything beside it would run on one core.
TEST(EmbreeScene, LeavesTheThreadsToOthers) {
  const auto limit = [] { return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism); };
  const std::size_t before = limit();
  EmbreeScene scene;
  scene.add_mesh(test::make_quad(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()), Vec3::Zero());
  scene.commit();
  EXPECT_EQ(limit(), before);
}

}  // namespace
}  // namespace smelt
