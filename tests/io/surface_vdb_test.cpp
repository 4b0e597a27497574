#include "io/surface_vdb.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/obj.h"
#include "io/vdb_file.h"
#include "tests/meshes.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetMeasure.h>
#include <tbb/global_control.h>

#include <numbers>

namespace smelt {
namespace {

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / ("surface_" + std::to_string(::getpid()) + "_" + name);
}

constexpr double radius = 0.5;
const Vec3 centre(0.3, 1.0, -2.0);

Vec3f velocity_at(const Vec3& x) {
  return Vec3f(static_cast<float>(x.y()), 2.0f, static_cast<float>(-x.x()));
}
float temperature_at(const Vec3& x) {
  return static_cast<float>(300.0 + 100.0 * x.z());
}

/// A sphere with linear fields on it.
SurfaceMesh make_surface() {
  SurfaceMesh s{make_sphere(centre, radius, 4), {}, {}, {}, {}, {}};
  for (const Vec3& x : s.mesh.vertices) {
    s.normals.push_back((x - centre).normalized().cast<float>());
    s.velocity.push_back(velocity_at(x));
    s.temperature.push_back(temperature_at(x));
    s.viscosity.push_back(7.0f);
    s.rest.push_back(2.0f * velocity_at(x));
  }
  return s;
}

template <typename Grid>
typename Grid::Ptr find_grid(const openvdb::GridPtrVec& grids, const std::string& name) {
  for (const auto& grid : grids)
    if (grid->getName() == name) return openvdb::gridPtrCast<Grid>(grid);
  ADD_FAILURE() << "no grid " << name;
  return Grid::create();
}

TEST(SurfaceVdb, WritesAFogVolumeOnRequest) {
  write_surface_vdb(temporary("fog.vdb"), make_surface(), 0.02, 12, 0.5, true);
  const auto grids = read_vdb(temporary("fog.vdb"));
  ASSERT_EQ(grids.size(), 6u);
  const auto fog = find_grid<openvdb::FloatGrid>(grids, "density");
  EXPECT_EQ(fog->getGridClass(), openvdb::GRID_FOG_VOLUME);
  EXPECT_EQ(fog->getCreator(), "smelt");
  EXPECT_EQ(fog->metaValue<std::int32_t>("frame"), 12);
  const auto at = [&](double r) {
    return fog->tree().getValue(
        openvdb::Coord::round(fog->worldToIndex(openvdb::Vec3d(centre[0] + r, centre[1], centre[2]))));
  };
  EXPECT_EQ(at(0.0), 1.0f);
  EXPECT_EQ(at(radius + 0.05), 0.0f);
  EXPECT_NEAR(at(radius - 0.03), 0.5f, 0.2f);
  EXPECT_EQ(find_grid<openvdb::FloatGrid>(grids, "surface")->metaValue<float>("half_width_voxels"), 3.0f);
}

TEST(SurfaceVdb, WritesALevelSetInMetres) {
  const SurfaceMesh s = make_surface();
  write_surface_vdb(temporary("level_set.vdb"), s, 0.02, 12, 0.5);
  const auto grids = read_vdb(temporary("level_set.vdb"));
  EXPECT_EQ(grids.size(), 5u);
  const auto level_set = find_grid<openvdb::FloatGrid>(grids, "surface");
  EXPECT_EQ(level_set->getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_DOUBLE_EQ(level_set->voxelSize().x(), 0.02);
  EXPECT_FLOAT_EQ(level_set->background(), 0.06f);
  EXPECT_EQ(level_set->getCreator(), "smelt");
  EXPECT_EQ(level_set->metaValue<std::int32_t>("frame"), 12);
  EXPECT_EQ(level_set->metaValue<double>("time"), 0.5);
  // Its volume, by OpenVDB; and the sign, deep inside and far outside.
  EXPECT_NEAR(openvdb::tools::levelSetVolume(*level_set) / compute_volume(s.mesh), 1.0, 2e-3);
  const auto accessor = level_set->getConstAccessor();
  const auto value_at = [&](const Vec3& x) {
    return accessor.getValue(openvdb::Coord::round(level_set->worldToIndex(openvdb::Vec3d(x.x(), x.y(), x.z()))));
  };
  EXPECT_FLOAT_EQ(value_at(centre), -0.06f);
  EXPECT_FLOAT_EQ(value_at(centre + Vec3(0.3, 0.3, 0.0)), -0.06f);
  EXPECT_FLOAT_EQ(value_at(centre + Vec3(2.0, 0.0, 0.0)), 0.06f);
  for (auto voxel = level_set->cbeginValueOn(); voxel; ++voxel) {
    const openvdb::Vec3d x = level_set->indexToWorld(voxel.getCoord());
    const double exact = (Vec3(x.x(), x.y(), x.z()) - centre).norm() - radius;
    ASSERT_NEAR(*voxel, exact, 2.5e-3) << "at most the sagitta of a triangle";
  }
}

TEST(SurfaceVdb, WritesFieldsOnTheBand) {
  write_surface_vdb(temporary("fields.vdb"), make_surface(), 0.02, 1, 0.0);
  const auto grids = read_vdb(temporary("fields.vdb"));
  const auto level_set = find_grid<openvdb::FloatGrid>(grids, "surface");
  const auto velocity = find_grid<openvdb::Vec3SGrid>(grids, "v");
  const auto temperature = find_grid<openvdb::FloatGrid>(grids, "temperature");
  EXPECT_EQ(velocity->getVectorType(), openvdb::VEC_CONTRAVARIANT_RELATIVE);
  EXPECT_TRUE(velocity->tree().hasSameTopology(level_set->tree()));
  EXPECT_TRUE(temperature->tree().hasSameTopology(level_set->tree()));
  for (auto voxel = velocity->cbeginValueOn(); voxel; ++voxel) {
    const openvdb::Vec3d at = velocity->indexToWorld(voxel.getCoord());
    const Vec3 x(at.x(), at.y(), at.z());
    const Vec3 nearest = centre + radius * (x - centre).normalized();
    const Vec3f v((*voxel).x(), (*voxel).y(), (*voxel).z());
    ASSERT_LT((v - velocity_at(nearest)).norm(), 1e-2);
    ASSERT_NEAR(temperature->tree().getValue(voxel.getCoord()), temperature_at(nearest), 0.5);
  }
}

TEST(SurfaceVdb, PutsASurfaceTogetherAgain) {
  const SurfaceMesh s = make_surface();
  write_obj(temporary("again.obj"), s);
  write_surface_vdb(temporary("again.vdb"), s, 0.02, 1, 0.0);
  const SurfaceMesh back = read_surface(temporary("again.obj"), temporary("again.vdb"));
  EXPECT_EQ(back.mesh.triangles, s.mesh.triangles);
  EXPECT_EQ(back.normals, s.normals);
  ASSERT_EQ(back.velocity.size(), s.velocity.size());
  ASSERT_EQ(back.temperature.size(), s.temperature.size());
  ASSERT_EQ(back.rest.size(), s.rest.size());
  ASSERT_EQ(back.viscosity.size(), s.viscosity.size());
  for (std::size_t i = 0; i < s.velocity.size(); ++i) {
    // Far less than the fields change over a voxel: 0.02 m/s and 2 K.
    ASSERT_LT((back.velocity[i] - s.velocity[i]).norm(), 2e-3);
    ASSERT_NEAR(back.temperature[i], s.temperature[i], 0.2);
    ASSERT_LT((back.rest[i] - s.rest[i]).norm(), 4e-3f);
    ASSERT_NEAR(back.viscosity[i], 7.0, 1e-5) << "a vertex near the end of the band";
  }
}

TEST(SurfaceVdb, LeavesOutWhatASurfaceDoesNotHave) {
  SurfaceMesh s = make_surface();
  s.temperature.clear();
  s.viscosity.clear();
  s.rest.clear();
  write_obj(temporary("cold.obj"), s);
  write_surface_vdb(temporary("cold.vdb"), s, 0.02, 1, 0.0);
  EXPECT_EQ(read_vdb(temporary("cold.vdb")).size(), 2u);
  EXPECT_TRUE(read_surface(temporary("cold.obj"), temporary("cold.vdb")).temperature.empty());
}

TEST(SurfaceVdb, HoldsAFrameWithoutSurface) {
  write_obj(temporary("none.obj"), {});
  write_surface_vdb(temporary("none.vdb"), {}, 0.02, 1, 0.0);
  EXPECT_TRUE(read_surface(temporary("none.obj"), temporary("none.vdb")).mesh.vertices.empty());
}

TEST(SurfaceVdb, CavitiesAndSecondBodiesHaveTheRightSign) {
  SurfaceMesh s;
  s.mesh = joined(joined(make_sphere(Vec3::Zero(), 1.0, 4), turned_inside_out(make_sphere(Vec3::Zero(), 0.5, 3))),
                  make_box({2, -1, -1}, {3, 1, 1}));
  s.velocity.assign(s.mesh.vertices.size(), Vec3f::Zero());
  write_surface_vdb(temporary("cavity.vdb"), s, 0.04, 1, 0.0);
  const auto level_set = find_grid<openvdb::FloatGrid>(read_vdb(temporary("cavity.vdb")), "surface");
  const double exact = compute_volume(s.mesh);
  EXPECT_NEAR(openvdb::tools::levelSetVolume(*level_set) / exact, 1.0, 5e-3);
  EXPECT_GT(level_set->tree().getValue(openvdb::Coord(0, 0, 0)), 0.0f);
  EXPECT_LT(level_set->tree().getValue(openvdb::Coord(18, 0, 0)), 0.0f);
  EXPECT_LT(level_set->tree().getValue(openvdb::Coord(62, 0, 0)), 0.0f);
}

TEST(SurfaceVdb, IsTheSameOnAnyNumberOfThreads) {
  const SurfaceMesh s = make_surface();
  std::vector<std::string> files;
  for (const std::size_t n_threads : {1, 2, 4}) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, n_threads);
    write_surface_vdb(temporary("threads.vdb"), s, 0.02, 1, 0.0);
    files.push_back(read_file(temporary("threads.vdb")));
  }
  EXPECT_TRUE(files[0] == files[1]);
  EXPECT_TRUE(files[0] == files[2]);
}

TEST(SurfaceVdb, NoticesFilesOfDifferentFrames) {
  SurfaceMesh s = make_surface();
  write_surface_vdb(temporary("frame.vdb"), s, 0.02, 1, 0.0);
  for (Vec3& x : s.mesh.vertices) x.y() += 0.5;
  write_obj(temporary("other_frame.obj"), s);
  std::string message = message_of<Error>([&] { read_surface(temporary("other_frame.obj"), temporary("frame.vdb")); });
  EXPECT_NE(message.find("not of the same frame"), std::string::npos) << message;
  const auto level_set = find_grid<openvdb::FloatGrid>(read_vdb(temporary("frame.vdb")), "surface");
  write_vdb(temporary("no_v.vdb"), {level_set});
  message = message_of<Error>([&] { read_surface(temporary("other_frame.obj"), temporary("no_v.vdb")); });
  EXPECT_NE(message.find("no vector grid `v`"), std::string::npos) << message;
}

}  // namespace
}  // namespace smelt
