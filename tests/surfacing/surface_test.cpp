#include "surfacing/surface.h"

#include "core/error.h"
#include "tests/surfacing/mesh_checks.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>

namespace smelt {
namespace {

constexpr double spacing = 0.03;

ParticleFrame make_frame(const std::vector<Vec3>& position) {
  ParticleFrame frame;
  frame.position = position;
  frame.velocity.assign(position.size(), Vec3f(1.0f, -2.0f, 0.5f));
  frame.density.assign(position.size(), 900.0f);
  frame.temperature.assign(position.size(), 350.0f);
  frame.id.resize(position.size());
  frame.mass = 900.0 * spacing * spacing * spacing;
  frame.spacing = spacing;
  frame.smoothing_length = 1.2 * spacing;
  frame.frame = 7;
  return frame;
}

/// Lattice points, `spacing` apart, of the box [0, n) spacings that a predicate of their lattice position keeps.
template <typename Keep>
ParticleFrame make_lattice(const Vec3& n, Keep&& keep) {
  std::vector<Vec3> x;
  for (double k = 0; k < n[2]; ++k)
    for (double j = 0; j < n[1]; ++j)
      for (double i = 0; i < n[0]; ++i)
        if (keep(Vec3(i, j, k))) x.push_back(spacing * Vec3(i + 0.13, j + 0.29, k + 0.41));
  return make_frame(x);
}

ParticleFrame make_lattice(const Vec3& n) {
  return make_lattice(n, [](const Vec3&) { return true; });
}

ParticleFrame make_ball(double radius_over_spacing) {
  const Vec3 centre = Vec3::Constant(std::ceil(radius_over_spacing)) + Vec3(0.2, 0.3, 0.1);
  return make_lattice(Vec3::Constant(2.0 * std::ceil(radius_over_spacing) + 2.0),
                      [&](const Vec3& x) { return (x - centre).norm() < radius_over_spacing; });
}

/// Volume of the surface over that of the particles.
double volume_ratio(const ParticleFrame& frame, const SurfacingOptions& options = {}) {
  const SurfaceMesh surface = build_surface(frame, options);
  EXPECT_EQ(testing::find_defect(surface.mesh), "");
  return compute_volume(surface.mesh) / (static_cast<double>(frame.size()) * spacing * spacing * spacing);
}

// Of two materials each particle stands for the same volume: the heavier half is as large as the lighter one.
TEST(Surface, ParticlesOfTwoDensitiesCountByTheirOwnMass) {
  ParticleFrame frame = make_ball(6.0);
  const TriangleMesh uniform = build_surface(frame, {}).mesh;
  const double middle = 6.3 * spacing;
  std::size_t n_heavy = 0;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const float factor = frame.position[i][0] < middle ? 3.0f : 1.0f;
    n_heavy += factor > 1.0f;
    frame.density[i] *= factor;
    frame.masses.push_back(static_cast<float>(frame.mass) * factor);
  }
  ASSERT_GT(n_heavy, frame.size() / 3);
  ASSERT_LT(n_heavy, 2 * frame.size() / 3);
  const TriangleMesh mixed = build_surface(frame, {}).mesh;
  ASSERT_EQ(mixed.triangles, uniform.triangles);
  for (std::size_t v = 0; v < mixed.vertices.size(); ++v)
    EXPECT_LT((mixed.vertices[v] - uniform.vertices[v]).norm(), 1e-4 * frame.spacing);
}

TEST(Surface, ABallOfTenThousandParticlesHasItsRadiusVolumeAndNormals) {
  const double radius = std::cbrt(3.0 * 10000.0 / (4.0 * std::numbers::pi));
  const ParticleFrame frame = make_ball(radius);
  const SurfaceMesh surface = build_surface(frame, {});
  ASSERT_EQ(testing::find_defect(surface.mesh), "");
  EXPECT_EQ(compute_topology(surface.mesh).euler_characteristic, 2);
  EXPECT_NEAR(compute_volume(surface.mesh) / (static_cast<double>(frame.size()) * spacing * spacing * spacing), 1.0,
              0.01);

  const Vec3 centre = spacing * (Vec3::Constant(std::ceil(radius)) + Vec3(0.33, 0.59, 0.51));
  double sum = 0.0, angle = 0.0;
  for (std::size_t v = 0; v < surface.normals.size(); ++v) {
    const Vec3 d = surface.mesh.vertices[v] - centre;
    sum += d.norm();
    angle += std::pow(std::acos(std::min(1.0, surface.normals[v].cast<double>().dot(d.normalized()))), 2);
  }
  const auto n = static_cast<double>(surface.normals.size());
  EXPECT_NEAR(sum / n / (radius * spacing), 1.0, 0.005);
  EXPECT_LT(std::sqrt(angle / n) * 180.0 / std::numbers::pi, 3.0);
}

TEST(Surface, ThinFeaturesKeepTheirVolumeAndPiece) {
  // Sheets, threads and drops one particle thick; bare chi loses all but the sheet.
  EXPECT_NEAR(volume_ratio(make_lattice(Vec3(30, 1, 30))), 1.0, 0.05);
  EXPECT_NEAR(volume_ratio(make_lattice(Vec3(1, 1, 40))), 1.0, 0.15);
  EXPECT_NEAR(volume_ratio(make_lattice(Vec3(2, 1, 1))), 1.0, 0.2);
  for (const double shift : {0.0, 0.1, 0.25, 0.4}) {
    const ParticleFrame drop = make_frame({spacing * Vec3(shift, 2.0 * shift, 3.0 * shift)});
    EXPECT_NEAR(volume_ratio(drop), 1.0, 0.25) << shift;
    EXPECT_EQ(compute_topology(build_surface(drop, {}).mesh).n_components, 1u);
  }
  SurfacingOptions bare;
  bare.thin_feature_gain = 0.0;
  bare.anisotropic = false;
  const SurfaceMesh nothing = build_surface(make_lattice(Vec3(1, 1, 40)), bare);
  EXPECT_TRUE(nothing.mesh.triangles.empty() && nothing.mesh.vertices.empty() && nothing.velocity.empty());
}

TEST(Surface, NoParticleDisappearsWhateverTheKernelTheIsoValueAndTheCell) {
  std::vector<Vec3> x;
  for (int i = 0; i < 40; ++i) x.push_back(spacing * Vec3(8.3 * i, 0.71 * i, -1.37 * i));
  for (const double gain : {0.1, 1.0})
    for (const double h : {0.6, 1.0, 1.5, 3.0})
      for (const double iso : {0.1, 0.5, 0.8})
        for (const double cell : {0.5, 0.75, 1.0, 1.25, 1.5}) {
          if (cell > 1.5 * h) continue;
          SurfacingOptions options;
          options.thin_feature_gain = gain;
          options.kernel_over_spacing = h;
          options.iso_value = iso;
          options.cell_over_spacing = cell;
          const SurfaceMesh surface = build_surface(make_frame(x), options);
          EXPECT_EQ(compute_topology(surface.mesh).n_components, x.size())
              << "gain " << gain << " h " << h << " iso " << iso << " cell " << cell;
        }
}

// A wide kernel of a height that any iso-value is below would make drops of 3 and 10 particles' volumes.
TEST(Surface, WideKernelsDoNotBlowUpDrops) {
  std::vector<Vec3> x;
  for (int i = 0; i < 40; ++i) x.push_back(spacing * Vec3(12.3 * i, 0.71 * i, -1.37 * i));
  for (const double h : {1.5, 2.0, 3.0}) {
    SurfacingOptions options;
    options.kernel_over_spacing = h;
    options.cell_over_spacing = 0.25;
    EXPECT_NEAR(volume_ratio(make_frame(x), options), 0.9, 0.1) << h;
  }
}

TEST(Surface, AVertexFartherOutThanAnyKernelHasAttributes) {
  std::vector<Vec3> x;
  for (int i = 0; i < 300; ++i) x.push_back(spacing * Vec3(4.27 * (i % 7), 4.71 * (i / 7 % 7), 4.37 * (i / 49)));
  SurfacingOptions wide, preview;
  wide.cell_over_spacing = 1.5;
  wide.iso_value = 0.07;
  preview.cell_over_spacing = 0.75;
  preview.iso_value = 0.01;
  for (SurfacingOptions options : {wide, preview}) {
    options.anisotropic = false;
    for (double gain : {0.0, 1.0}) {
      options.thin_feature_gain = gain;
      const SurfaceMesh surface = build_surface(make_frame(x), options);
      for (const Vec3f& v : surface.velocity) ASSERT_LT((v - Vec3f(1.0f, -2.0f, 0.5f)).norm(), 1e-5f);
      for (const float t : surface.temperature) ASSERT_NEAR(t, 350.0f, 1e-3f);
    }
  }
}

TEST(Surface, AThreadBetweenTwoBallsIsNotSmoothedAway) {
  const ParticleFrame frame = make_lattice(Vec3(13, 13, 49), [](const Vec3& x) {
    return (x - Vec3(6, 6, 6)).norm() < 6 || (x - Vec3(6, 6, 42)).norm() < 6 || (x[0] == 6 && x[1] == 6);
  });
  SurfacingOptions options;
  options.smoothing_passes = 60;
  const SurfaceMesh surface = build_surface(frame, options);
  EXPECT_EQ(compute_topology(surface.mesh).n_components, 1u);
  double thinnest = 1e300;
  for (const Vec3& x : surface.mesh.vertices)
    if (std::abs(x[2] / spacing - 24.41) < 8.0)
      thinnest = std::min(thinnest, std::hypot(x[0] / spacing - 6.13, x[1] / spacing - 6.29));
  EXPECT_GT(thinnest, 0.45);  // a thread of its volume has the radius 0.56
}

TEST(Surface, AttributesFollowTheParticles) {
  ParticleFrame frame = make_ball(8.0);
  frame.viscosity.assign(frame.size(), 12.5f);
  for (const Vec3& x : frame.position) frame.rest.push_back((x + Vec3(5.0, 0.0, 0.0)).cast<float>());
  for (std::size_t i = 0; i < frame.size(); ++i)
    frame.temperature[i] = 300.0f + 100.0f * static_cast<float>(frame.position[i][1]);
  const SurfaceMesh surface = build_surface(frame, {});
  const std::size_t n = surface.mesh.vertices.size();
  ASSERT_EQ(surface.temperature.size(), n);
  ASSERT_EQ(surface.viscosity.size(), n);
  for (std::size_t v = 0; v < n; ++v) {
    ASSERT_NEAR((surface.velocity[v] - Vec3f(1.0f, -2.0f, 0.5f)).norm(), 0.0f, 1e-5f);
    ASSERT_NEAR(surface.viscosity[v], 12.5f, 1e-4f);
    ASSERT_LT((surface.rest[v].cast<double>() - surface.mesh.vertices[v] - Vec3(5.0, 0.0, 0.0)).cwiseAbs().maxCoeff(),
              spacing);
    // On the surface all particles lie to one side: the average is that of a point less than a spacing further in.
    ASSERT_NEAR(surface.temperature[v], 300.0 + 100.0 * surface.mesh.vertices[v][1], 100.0 * spacing);
  }
  frame.temperature.clear();
  frame.viscosity.clear();
  frame.rest.clear();
  const SurfaceMesh plain = build_surface(frame, {});
  EXPECT_TRUE(plain.temperature.empty());
  EXPECT_TRUE(plain.viscosity.empty());
  EXPECT_TRUE(plain.rest.empty());
  EXPECT_EQ(plain.velocity.size(), n);
}

TEST(Surface, SameBytesOnOneAndTwoThreads) {
  ParticleFrame frame = make_ball(9.0);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-0.3 * spacing, 0.3 * spacing);
  for (Vec3& x : frame.position) x += Vec3(jitter(random), jitter(random), jitter(random));
  const auto build = [&](std::size_t n_threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n_threads);
    return build_surface(frame, {});
  };
  const SurfaceMesh one = build(1), two = build(2), four = build(4);
  for (const SurfaceMesh* other : {&two, &four}) {
    ASSERT_EQ(one.mesh.triangles, other->mesh.triangles);
    const auto same_bytes = [](const auto& a, const auto& b) {
      return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
    };
    EXPECT_TRUE(same_bytes(one.mesh.vertices, other->mesh.vertices));
    EXPECT_TRUE(same_bytes(one.normals, other->normals));
    EXPECT_TRUE(same_bytes(one.velocity, other->velocity));
    EXPECT_TRUE(same_bytes(one.temperature, other->temperature));
  }
}

TEST(Surface, RefusesBadInput) {
  EXPECT_THROW(build_surface(make_frame({}), {}), Error);
  const auto expect_refused = [](void (*break_it)(ParticleFrame&), const std::string& what) {
    ParticleFrame frame = make_lattice(Vec3(4, 4, 4));
    for (std::size_t i = 0; i < frame.size(); ++i) frame.id[i] = static_cast<std::int32_t>(1000 + i);
    frame.masses.assign(frame.size(), static_cast<float>(frame.mass));
    frame.viscosity.assign(frame.size(), 1.0f);
    frame.rest.assign(frame.size(), Vec3f::Zero());
    break_it(frame);
    try {
      build_surface(frame, {});
      ADD_FAILURE() << "accepted: " << what;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("frame 7: particle 1005 " + what), std::string::npos) << error.what();
    }
  };
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  expect_refused([](ParticleFrame& p) { p.position[5][1] = nan; }, "has the position");
  expect_refused([](ParticleFrame& p) { p.position[5][2] = -1e9; }, "is at");
  expect_refused([](ParticleFrame& p) { p.density[5] = 0.0f; }, "has the density 0 kg/m3: it must be positive");
  expect_refused([](ParticleFrame& p) { p.density[5] = infinity; }, "has the density inf");
  expect_refused([](ParticleFrame& p) { p.masses[5] = -1.0f; }, "has the mass -1 kg");
  expect_refused([](ParticleFrame& p) { p.velocity[5][0] = infinity; }, "has the velocity (inf, -2, 0.5) m/s");
  expect_refused([](ParticleFrame& p) { p.temperature[5] = nan; }, "has the temperature nan K: it must be finite");
  expect_refused([](ParticleFrame& p) { p.viscosity[5] = infinity; }, "has the viscosity inf Pa s");
  expect_refused([](ParticleFrame& p) { p.rest[5][2] = nan; }, "has the rest position");
  // Of several the first.
  expect_refused([](ParticleFrame& p) { p.density[5] = p.density[60] = p.density[6] = 0.0f; }, "has the density");

  ParticleFrame frame = make_lattice(Vec3(4, 4, 4));
  for (auto break_it : std::initializer_list<void (*)(SurfacingOptions&)>{
           [](SurfacingOptions& o) { o.iso_value = 0.0; }, [](SurfacingOptions& o) { o.iso_value = 1.0; },
           [](SurfacingOptions& o) { o.cell_over_spacing = 0.0; },
           [](SurfacingOptions& o) { o.cell_over_spacing = 1e-5; },
           [](SurfacingOptions& o) { o.kernel_over_spacing = -1.0; },
           [](SurfacingOptions& o) { o.cell_over_spacing = 1.6; }, [](SurfacingOptions& o) { o.smoothing_passes = -1; },
           [](SurfacingOptions& o) { o.thin_feature_gain = std::numeric_limits<double>::quiet_NaN(); }}) {
    SurfacingOptions options;
    break_it(options);
    EXPECT_THROW(build_surface(frame, options), Error);
  }
  EXPECT_THROW(build_surface(make_frame(std::vector<Vec3>(20, Vec3(1, 2, 3))), {}), Error) << "all at one place";
}

// Measured at 11 MB; chi alone, without the mesh around it, is 2 MB.
TEST(Surface, RefusesWhatWouldNotFitIntoMemory) {
  const ParticleFrame frame = make_ball(20.0);
  SurfacingOptions options;
  options.memory_limit_bytes = 20e6;
  EXPECT_FALSE(build_surface(frame, options).mesh.triangles.empty());
  options.memory_limit_bytes = 8e6;
  try {
    build_surface(frame, options);
    ADD_FAILURE() << "8 MB were enough";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("0.008 GB"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("surface.cell_over_spacing"), std::string::npos) << error.what();
  }
}

// Loose webs of particles: threads, holes and drops, where smoothing is weak nearly everywhere and volumes are hard to
// give back.
TEST(Surface, LooseWebsStayAtTheirParticles) {
  double farthest = 0.0;
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    ParticleFrame frame;
    frame.spacing = 1.0;
    frame.mass = 1000.0;
    Box3 bounds;
    for (int i = 0; i < 900; ++i) {
      // A crumpled sheet, thinned out.
      const double x = 16.0 * uniform(random), z = 16.0 * uniform(random);
      frame.position.push_back(Vec3(x, 2.0 * std::sin(0.5 * x + seed) * std::cos(0.4 * z) + 1.5 * uniform(random), z));
      frame.velocity.push_back(Vec3f::Zero());
      frame.density.push_back(1000.0f);
      frame.id.push_back(i);
      bounds.extend(frame.position.back());
    }
    const SurfaceMesh surface = build_surface(frame, {});
    for (const Vec3& v : surface.mesh.vertices)
      farthest = std::max({farthest, (bounds.lower - v).maxCoeff(), (v - bounds.upper).maxCoeff()});
  }
  EXPECT_LT(farthest, 1.5);
}

}  // namespace
}  // namespace smelt
