#include "io/obj.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/mesh_import.h"
#include "tests/io/disk_limit.h"
#include "tests/meshes.h"

#include <tbb/global_control.h>

#include <limits>

namespace smelt {
namespace {

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / ("obj_" + std::to_string(::getpid()) + "_" + name);
}

SurfaceMesh make_surface() {
  SurfaceMesh surface{make_sphere({0.1, 1e-3, -2e4}, 0.7, 5), {}, {}, {}, {}, {}};
  for (const Vec3& v : surface.mesh.vertices)
    surface.normals.push_back((v - Vec3(0.1, 1e-3, -2e4)).normalized().cast<float>());
  return surface;
}

TEST(Obj, ReadsBackTheSameFloats) {
  const SurfaceMesh surface = make_surface();
  write_obj(temporary("round_trip.obj"), surface);
  const SurfaceMesh back = read_obj(temporary("round_trip.obj"));
  ASSERT_EQ(back.mesh.vertices.size(), surface.mesh.vertices.size());
  for (std::size_t i = 0; i < back.mesh.vertices.size(); ++i)
    ASSERT_EQ(back.mesh.vertices[i], surface.mesh.vertices[i].cast<float>().cast<double>());
  EXPECT_EQ(back.normals, surface.normals);
  EXPECT_EQ(back.mesh.triangles, surface.mesh.triangles);
  EXPECT_TRUE(back.velocity.empty());
}

TEST(Obj, IsTheSameOnAnyNumberOfThreads) {
  const SurfaceMesh surface = make_surface();
  std::vector<std::string> files;
  for (const std::size_t n_threads : {1, 2, 4}) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, n_threads);
    write_obj(temporary("threads.obj"), surface);
    files.push_back(read_file(temporary("threads.obj")));
  }
  EXPECT_EQ(files[0], files[1]);
  EXPECT_EQ(files[0], files[2]);
}

TEST(Obj, LooksAsOtherProgramsExpect) {
  SurfaceMesh surface{make_box(Vec3::Zero(), {1.0, 0.5, 1e-7}), std::vector<Vec3f>(8, Vec3f(0, 1, 0)), {}, {}, {}, {}};
  surface.mesh.triangles.resize(1);
  write_obj(temporary("look.obj"), surface);
  const std::string text = read_file(temporary("look.obj"));
  EXPECT_EQ(text.find("# smelt surface: 8 vertices, 1 triangles\nv 0 0 0\nv 1 0 0\nv 0 0.5 0\n"), 0u) << text;
  EXPECT_NE(text.find("\nv 1 0.5 1e-07\nvn 0 1 0\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\nf 1//1 3//3 4//4\n"), std::string::npos) << text;
  // And assimp reads it.
  surface.mesh = make_box(Vec3::Zero(), Vec3::Ones());
  write_obj(temporary("look.obj"), surface);
  EXPECT_DOUBLE_EQ(compute_volume(import_mesh(temporary("look.obj"))), 1.0);
}

TEST(Obj, HoldsAFrameWithoutSurface) {
  write_obj(temporary("none.obj"), {});
  EXPECT_TRUE(read_obj(temporary("none.obj")).mesh.triangles.empty());
}

TEST(Obj, RefusesToWriteWhatIsNotFinite) {
  SurfaceMesh surface{make_box(Vec3::Zero(), Vec3::Ones()), std::vector<Vec3f>(8, Vec3f(0, 1, 0)), {}, {}, {}, {}};
  surface.mesh.vertices[3].x() = std::numeric_limits<double>::quiet_NaN();
  const std::string message = message_of<Error>([&] { write_obj(temporary("nan.obj"), surface); });
  EXPECT_NE(message.find("nan.obj: vertex 4 is (nan, 1, 0)"), std::string::npos) << message;
  EXPECT_FALSE(std::filesystem::exists(temporary("nan.obj")));
}

TEST(Obj, ReportsAFullDisk) {
  const SurfaceMesh surface = make_surface();
  std::filesystem::remove(temporary("full.obj"));
  {
    const DiskLimit limit(1 << 14);
    EXPECT_THROW(write_obj(temporary("full.obj"), surface), Error);
  }
  EXPECT_FALSE(std::filesystem::exists(temporary("full.obj")));
  EXPECT_FALSE(std::filesystem::exists(temporary("full.obj.tmp")));
}

TEST(Obj, NamesTheLineOfDamage) {
  const std::string box = "v 0 0 0\nv 1 0 0\n\n# comment\nv 0 1 0\n";
  const auto refuses = [&](const std::string& text, const std::string& why) {
    write_file_atomically(temporary("damaged.obj"), text);
    const std::string message = message_of<Error>([&] { read_obj(temporary("damaged.obj")); });
    EXPECT_NE(message.find(why), std::string::npos) << message << "\nfor\n" << text;
  };
  refuses(box + "f 1 2 4\n", "damaged.obj:6: expected a vertex from 1 to 3, given before the face, found '4'");
  refuses(box + "f 1 2 0\n", ":6: expected an index from 1, found '0'");
  refuses(box + "f 1 2 -1\n", ":6: expected an index from 1, found '-1'");
  refuses(box + "f 1 2\n", ":6: expected an index from 1, found ''");
  refuses(box + "f 1 2 3 3\n", ":6: expected a triangle, found '3'");
  refuses(box + "f 1//1 2//2 3//1\n", ":6: expected a normal with the index of its vertex");
  refuses(box + "v 1 nan 0\n", ":6: expected a finite number, found 'nan'");
  refuses(box + "v 1 2\n", ":6: expected a finite number, found ''");
  refuses(box + "v 1 2 3 4\n", ":6: expected three numbers, or six with a colour, found '4'");
  refuses(box + "vx 1 2 3\n", ":6: expected v, vn or f, found 'vx'");
  refuses(box + "vn 0 0 1\nf 1 2 3\n", "1 normals for 3 vertices");
  refuses(box, "has no triangles");
  refuses("", "has no triangles");
}

TEST(Obj, NoticesATruncatedFile) {
  write_obj(temporary("whole.obj"), make_surface());
  const std::string text = read_file(temporary("whole.obj"));
  // Cut at the end of a line, where every line by itself is sound.
  write_file_atomically(temporary("cut.obj"), text.substr(0, text.rfind("\nf ") + 1));
  const std::string message = message_of<Error>([&] { read_obj(temporary("cut.obj")); });
  EXPECT_NE(message.find("6146 vertices and 12287 triangles where its first line gives 6146 and 12288"),
            std::string::npos)
      << message;
}

}  // namespace
}  // namespace smelt
