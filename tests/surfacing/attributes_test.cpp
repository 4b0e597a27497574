#include "surfacing/attributes.h"

#include "core/sph/kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace smelt {
namespace {

constexpr double h = 0.05;

/// Particles of random volumes and values in a box of 10 h.
struct Cloud {
  ParticleFrame frame;
  ParticleBins bins;
  std::vector<float> volume, extra;  // sorted

  explicit Cloud(std::size_t n) {
    std::mt19937 random(8);
    std::uniform_real_distribution<double> place(-5.0 * h, 5.0 * h);
    std::uniform_real_distribution<float> value(1.0f, 2.0f);
    for (std::size_t i = 0; i < n; ++i) {
      frame.position.push_back(Vec3(place(random), place(random), place(random)) + Vec3(3.0, 0.0, -7.0));
      frame.velocity.push_back(Vec3f(value(random), -value(random), 3.0f * value(random)));
      frame.temperature.push_back(300.0f * value(random));
      frame.viscosity.push_back(value(random));
      frame.rest.push_back(Vec3f(value(random), value(random), -value(random)));
      volume.push_back(1e-6f * value(random));
      extra.push_back(value(random));
    }
    bins = sort_into_bins(frame.position, 2.0 * h);
  }
};

/// Every field against the same average as a double sum over all particles.
TEST(Attributes, AreShepardsAveragesOfAllFields) {
  const Cloud cloud(3000);
  const Kernel<3> kernel(h);
  SurfaceMesh surface;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> place(-5.0 * h, 5.0 * h);
  for (int v = 0; v < 500; ++v)
    surface.mesh.vertices.push_back(Vec3(place(random), place(random), place(random)) + Vec3(3.0, 0.0, -7.0));
  const std::vector<float> extra = compute_attributes(surface, cloud.frame, cloud.bins, cloud.volume, cloud.extra, h);
  for (std::size_t v = 0; v < surface.mesh.vertices.size(); ++v) {
    double total = 0.0, temperature = 0.0, viscosity = 0.0, of_extra = 0.0;
    Vec3 velocity = Vec3::Zero(), rest = Vec3::Zero();
    for (std::size_t j = 0; j < cloud.volume.size(); ++j) {
      const std::size_t i = cloud.bins.index[j];
      const double w = cloud.volume[j] * kernel.value((surface.mesh.vertices[v] - cloud.frame.position[i]).norm());
      total += w;
      velocity += w * cloud.frame.velocity[i].cast<double>();
      temperature += w * static_cast<double>(cloud.frame.temperature[i]);
      viscosity += w * static_cast<double>(cloud.frame.viscosity[i]);
      rest += w * cloud.frame.rest[i].cast<double>();
      of_extra += w * static_cast<double>(cloud.extra[j]);
    }
    ASSERT_LT((surface.velocity[v].cast<double>() - velocity / total).norm(), 1e-5);
    ASSERT_NEAR(surface.temperature[v], temperature / total, 1e-3);
    ASSERT_NEAR(surface.viscosity[v], viscosity / total, 1e-5);
    ASSERT_LT((surface.rest[v].cast<double>() - rest / total).norm(), 1e-5);
    ASSERT_NEAR(extra[v], of_extra / total, 1e-5);
  }
}

/// Farther than 2 h from all: the values of what is nearest, never nothing.
TEST(Attributes, BeyondAllKernelsAreThoseOfTheNearestParticles) {
  const Cloud cloud(1);
  SurfaceMesh surface;
  const std::vector<double> distances = {0.5, 1.9, 2.0, 2.1, 3.9, 4.5, 100.0};
  for (const double d : distances)
    surface.mesh.vertices.push_back(cloud.frame.position[0] + d * h * Vec3(0.6, -0.8, 0.0));
  const std::vector<float> extra = compute_attributes(surface, cloud.frame, cloud.bins, cloud.volume, cloud.extra, h);
  for (std::size_t v = 0; v < distances.size(); ++v) {
    EXPECT_FLOAT_EQ(surface.temperature[v], cloud.frame.temperature[0]) << distances[v];
    EXPECT_FLOAT_EQ(surface.velocity[v][2], cloud.frame.velocity[0][2]) << distances[v];
    EXPECT_FLOAT_EQ(surface.rest[v][0], cloud.frame.rest[0][0]) << distances[v];
    EXPECT_FLOAT_EQ(extra[v], cloud.extra[0]) << distances[v];
  }
}

}  // namespace
}  // namespace smelt
