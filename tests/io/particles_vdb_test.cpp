#include "io/particles_vdb.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/vdb_file.h"
#include "tests/io/disk_limit.h"
#include "tests/meshes.h"

#include <openvdb/openvdb.h>
#include <openvdb/points/PointConversion.h>
#include <tbb/global_control.h>

#include <numeric>
#include <random>

namespace smelt {
namespace {

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / ("particles_" + std::to_string(::getpid()) + "_" + name);
}

/// `n` particles scattered through a cube about `centre`, some of them in the same place.
ParticleFrame make_frame(std::size_t n, const Vec3& centre, double spacing) {
  ParticleFrame p;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const double half_width = 0.5 * spacing * std::cbrt(static_cast<double>(n));
  for (std::size_t i = 0; i < n; ++i) {
    p.position.push_back(i % 100 == 99
                             ? p.position.back()
                             : Vec3(centre + half_width * Vec3(uniform(random), uniform(random), uniform(random))));
    p.velocity.emplace_back(uniform(random), -1e-9f, 3e7f);
    p.density.push_back(static_cast<float>(900.0 + uniform(random)));
    p.temperature.push_back(static_cast<float>(350.0 + 50.0 * uniform(random)));
    p.viscosity.push_back(static_cast<float>(std::exp(9.0 * uniform(random))));
    p.rest.emplace_back(uniform(random), 7.0f, uniform(random));
    p.id.push_back(static_cast<std::int32_t>(3 * i));
  }
  p.mass = 0.1;
  p.spacing = spacing;
  p.smoothing_length = 1.3 * spacing;
  p.frame = 17;
  p.time = 2.0 / 3.0;
  return p;
}

TEST(ParticlesVdb, ReadsBackEverything) {
  const ParticleFrame p = make_frame(3000, Vec3(3.0, -2.0, 1.0), 0.1);
  write_particles(temporary("particles.vdb"), p);
  const ParticleFrame back = read_particles(temporary("particles.vdb"));
  EXPECT_EQ(back.id, p.id);
  EXPECT_EQ(back.velocity, p.velocity);
  EXPECT_EQ(back.density, p.density);
  EXPECT_EQ(back.temperature, p.temperature);
  EXPECT_EQ(back.viscosity, p.viscosity);
  EXPECT_EQ(back.rest, p.rest);
  EXPECT_EQ(back.mass, p.mass);
  EXPECT_EQ(back.spacing, p.spacing);
  EXPECT_EQ(back.smoothing_length, p.smoothing_length);
  EXPECT_EQ(back.frame, p.frame);
  EXPECT_EQ(back.time, p.time);
}

TEST(ParticlesVdb, KeepsPositionsFarFromTheOrigin) {
  for (const double distance : {0.0, 1.0, 1e3}) {
    const ParticleFrame p = make_frame(3000, Vec3::Constant(distance), 0.01);
    write_particles(temporary("far.vdb"), p);
    const ParticleFrame back = read_particles(temporary("far.vdb"));
    ASSERT_EQ(back.size(), p.size());
    double worst = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i)
      worst = std::max(worst, (back.position[i] - p.position[i]).cwiseAbs().maxCoeff() / p.spacing);
    EXPECT_LT(worst, 1.2e-7) << "in spacings, at " << distance << " m";
    EXPECT_GT(worst, 1e-9) << "a better format than thought: say so in the header";
  }
}

TEST(ParticlesVdb, LeavesOutWhatAFrameDoesNotHave) {
  ParticleFrame p = make_frame(100, Vec3::Zero(), 0.1);
  p.temperature.clear();
  p.viscosity.clear();
  p.rest.clear();
  write_particles(temporary("cold.vdb"), p);
  const ParticleFrame back = read_particles(temporary("cold.vdb"));
  EXPECT_EQ(back.size(), 100u);
  EXPECT_TRUE(back.temperature.empty());
  EXPECT_TRUE(back.viscosity.empty());
}

TEST(ParticlesVdb, HoldsAFrameWithoutParticles) {
  ParticleFrame p;
  p.spacing = 0.1;
  write_particles(temporary("none.vdb"), p);
  EXPECT_EQ(read_particles(temporary("none.vdb")).size(), 0u);
}

TEST(ParticlesVdb, BytesDependNeitherOnThreadsNorOnTheOrderOfParticles) {
  const ParticleFrame p = make_frame(20000, Vec3::Zero(), 0.1);
  std::vector<std::string> files;
  for (const std::size_t n_threads : {1, 2, 4, 2}) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, n_threads);
    write_particles(temporary("threads.vdb"), p);
    files.push_back(read_file(temporary("threads.vdb")));
  }
  ParticleFrame shuffled = p;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const std::size_t from = (i * 7919) % p.size();
    shuffled.position[i] = p.position[from];
    shuffled.velocity[i] = p.velocity[from];
    shuffled.density[i] = p.density[from];
    shuffled.temperature[i] = p.temperature[from];
    shuffled.viscosity[i] = p.viscosity[from];
    shuffled.rest[i] = p.rest[from];
    shuffled.id[i] = p.id[from];
  }
  write_particles(temporary("threads.vdb"), shuffled);
  files.push_back(read_file(temporary("threads.vdb")));
  for (std::size_t i = 1; i < files.size(); ++i) EXPECT_TRUE(files[i] == files[0]) << "file " << i;
}

TEST(ParticlesVdb, RefusesAParticleBeyondTheGrid) {
  ParticleFrame p = make_frame(10, Vec3::Zero(), 0.1);
  p.position[4].y() = -1e12;
  const std::string message = message_of<Error>([&] { write_particles(temporary("escaped.vdb"), p); });
  EXPECT_NE(message.find("particle 12 at ("), std::string::npos) << message;
}

TEST(ParticlesVdb, ReportsAFullDisk) {
  const ParticleFrame p = make_frame(3000, Vec3::Zero(), 0.1);
  const DiskLimit limit(20000);
  EXPECT_THROW(write_particles(temporary("full.vdb"), p), Error);
  EXPECT_FALSE(std::filesystem::exists(temporary("full.vdb.tmp")));
}

TEST(ParticlesVdb, NamesWhatAForeignFileLacks) {
  const auto refuses = [](const openvdb::GridBase::Ptr& grid, const std::string& why) {
    write_vdb(temporary("foreign.vdb"), {grid});
    const std::string message = message_of<Error>([&] { read_particles(temporary("foreign.vdb")); });
    EXPECT_EQ(message.find(temporary("foreign.vdb").string()), 0u) << message;
    EXPECT_NE(message.find(why), std::string::npos) << message;
  };
  openvdb::initialize();
  namespace vp = openvdb::points;
  refuses(openvdb::FloatGrid::create(), "no point grid named `points`");
  const std::vector<openvdb::Vec3d> positions = {{0, 0, 0}, {1, 1, 1}};
  const auto grid = vp::createPointDataGrid<vp::NullCodec, vp::PointDataGrid>(
      positions, *openvdb::math::Transform::createLinearTransform(1.0));
  grid->setName("points");
  refuses(grid, "lacks the metadata `frame`");
  grid->insertMeta("frame", openvdb::Int32Metadata(1));
  for (const char* name : {"time", "mass", "spacing", "smoothing_length"})
    grid->insertMeta(name, openvdb::DoubleMetadata(1.0));
  refuses(grid, "lack the attribute `id`");
  vp::appendAttribute(grid->tree(), "id", vp::TypedAttributeArray<std::int32_t>::attributeType());
  refuses(grid, "two points have the id 0");
  vp::dropAttribute(grid->tree(), "id");
  vp::appendAttribute(grid->tree(), "id", vp::TypedAttributeArray<float>::attributeType());
  refuses(grid, "`id` of the points is of type float, not int32");
}

}  // namespace
}  // namespace smelt
