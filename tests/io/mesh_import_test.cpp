#include "io/mesh_import.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "tests/meshes.h"
#include "tests/source_folder.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace smelt {
namespace {

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / ("import_" + std::to_string(::getpid()) + "_" + name);
}

std::filesystem::path asset(const std::string& name) {
  return source_folder() / "assets" / name;
}

TriangleMesh import_text(const std::string& name, const std::string& text) {
  write_file_atomically(temporary(name), text);
  return import_mesh(temporary(name));
}

const TriangleMesh box = make_box({0, 0, 0}, {1, 2, 4});

void expect_box(const TriangleMesh& mesh) {
  EXPECT_EQ(mesh.vertices.size(), 8u);
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_TRUE(compute_topology(mesh).closed());
  EXPECT_NEAR(compute_volume(mesh), 8.0, 1e-6);
  EXPECT_LT((compute_bounds(mesh).upper - Vec3(1, 2, 4)).norm(), 1e-6);
}

template <typename T>
void append_bytes(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string ply_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment made by hand\nelement vertex 8\nproperty double x\nproperty double y\nproperty double "
         "z\nelement face 12\n"
         "property list uchar int vertex_indices\nend_header\n";
}

TEST(MeshImport, ReadsTheBunny) {
  const TriangleMesh bunny = import_mesh(asset("bunny.obj")), expected = load_asset("bunny.obj");
  ASSERT_EQ(bunny.vertices.size(), expected.vertices.size());
  EXPECT_EQ(bunny.triangles.size(), expected.triangles.size());
  EXPECT_TRUE(compute_topology(bunny).closed());
  EXPECT_NEAR(compute_volume(bunny) / compute_volume(expected), 1.0, 1e-7);
}

TEST(MeshImport, ReadsObjWithQuadsNegativeIndicesAndPoints) {
  std::string text;
  for (const Vec3& v : box.vertices) text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
  expect_box(import_text("quads.obj",
                         text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf -6 -2 -1 -5\nf 1 5 7 3\nf 2 4 8 6\np 1\nl 1 8\n"));
}

TEST(MeshImport, ReadsPly) {
  std::string ascii = ply_header("ascii"), binary = ply_header("binary_little_endian");
  for (const Vec3& v : box.vertices) {
    ascii += fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
    for (const double x : v) append_bytes(binary, x);
  }
  for (const auto& t : box.triangles) {
    ascii += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
    append_bytes(binary, std::uint8_t{3});
    for (const std::uint32_t v : t) append_bytes(binary, v);
  }
  expect_box(import_text("ascii.ply", ascii));
  expect_box(import_text("binary.ply", binary));
}

// Vertices that no face uses neither blow up what is welded nor need be numbers.
TEST(MeshImport, LeavesOutVerticesThatNoFaceUses) {
  std::string text = ply_header("ascii");
  text.replace(text.find("vertex 8"), 8, "vertex 10");
  text += "1e30 1e30 1e30\n";
  for (const Vec3& v : box.vertices) text += fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
  text += "nan 0 0\n";
  for (const auto& t : box.triangles) text += fmt::format("3 {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  expect_box(import_text("loose.ply", text));
}

TEST(MeshImport, ReadsStlAndWeldsItsCorners) {
  std::string ascii = "solid box\n", binary(80, '\0');
  append_bytes(binary, std::uint32_t{12});
  for (const auto& t : box.triangles) {
    ascii += "facet normal 0 0 0\nouter loop\n";
    for (int k = 0; k < 3; ++k) append_bytes(binary, 0.0f);
    for (const std::uint32_t v : t) {
      ascii += fmt::format("vertex {} {} {}\n", box.vertices[v].x(), box.vertices[v].y(), box.vertices[v].z());
      for (const double x : box.vertices[v]) append_bytes(binary, static_cast<float>(x));
    }
    ascii += "endloop\nendfacet\n";
    append_bytes(binary, std::uint16_t{0});
  }
  expect_box(import_text("ascii.stl", ascii + "endsolid box\n"));
  expect_box(import_text("binary.STL", binary));
}

TEST(MeshImport, ReadsOff) {
  std::string text = "OFF\n8 12 0\n";
  for (const Vec3& v : box.vertices) text += fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
  for (const auto& t : box.triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  expect_box(import_text("box.off", text));
}

/// A glTF file of the unit box under two nodes: scaled to the test's box, and mirrored at x = 0.
std::string make_gltf() {
  std::string buffer;
  const TriangleMesh unit = make_box(Vec3::Zero(), Vec3::Ones());
  for (const Vec3& v : unit.vertices)
    for (const double x : v) append_bytes(buffer, static_cast<float>(x));
  for (const auto& t : unit.triangles)
    for (const std::uint32_t v : t) append_bytes(buffer, static_cast<std::uint16_t>(v));
  write_file_atomically(temporary("box.bin"), buffer);
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"children": [1, 2]}, {"mesh": 0, "scale": [1, 2, 4]}, {"mesh": 0, "scale": [-1, 2, 4]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "accessors": [
      {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
      {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
    "buffers": [{"uri": ")" +
         temporary("box.bin").filename().string() + R"(", "byteLength": 168}]})";
}

TEST(MeshImport, AppliesTheNodesOfGltfAndJoinsItsMeshes) {
  const TriangleMesh mesh = import_text("box.gltf", make_gltf());
  EXPECT_EQ(mesh.triangles.size(), 24u);
  // A mirrored part that kept its winding would cancel the other.
  EXPECT_NEAR(compute_volume(mesh), 16.0, 1e-5);
  EXPECT_LT((compute_bounds(mesh).lower - Vec3(-1, 0, 0)).norm(), 1e-6);
}

TEST(MeshImport, SaysWhatIsWrongWithAFile) {
  const auto refuses = [](const std::string& name, const std::string& why) {
    const std::string message = message_of<Error>([&] { import_mesh(asset(name)); });
    EXPECT_EQ(message.find(asset(name).string()), 0u) << message;
    EXPECT_NE(message.find(why), std::string::npos) << message;
  };
  refuses("bad/none.obj", "there is no such file");
  refuses("bad", "is not a file");
  refuses("bad/empty.obj", "empty");
  refuses("bad/scene.blend", "'.blend' files; allowed are .obj .ply .stl .off .gltf .glb");
  refuses("bad/nan.obj", "face 3 has a vertex at (0, nan, 1)");
  refuses("bad/bad_index.obj", "index out of range");
  refuses("bad/no_faces.obj", "cannot be read");
  refuses("bad/not_a_mesh.obj", "has no faces");
  refuses("bad/truncated.ply", "ends in face 6 of the 12");
  refuses("bad/truncated_binary.ply", "ends in face 6 of the 12");
  refuses("bad/truncated.stl", "cannot be read");
  refuses("bad/truncated.off", "face 5 has no corners: the file is truncated");
  refuses("bad/truncated.gltf", "cannot be read");
}

TEST(MeshImport, EndsOnPlyFilesCutAnywhere) {
  std::string text = ply_header("ascii");
  for (const Vec3& v : box.vertices) text += fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
  for (const auto& t : box.triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  for (std::size_t n = 0; n + 2 < text.size(); n += 7)
    EXPECT_THROW(import_text("cut.ply", text.substr(0, n)), Error) << "cut after " << n << " bytes";
}

TEST(MeshImport, ReadsFaultyMeshesForTheRepair) {
  EXPECT_EQ(compute_topology(import_mesh(asset("bad/open_box.obj"))).n_boundary_edges, 4u);
  EXPECT_EQ(compute_topology(import_mesh(asset("bad/misoriented_box.obj"))).n_misoriented_edges, 3u);
  EXPECT_LT(compute_volume(import_mesh(asset("bad/inverted_box.obj"))), 0.0);
}

}  // namespace
}  // namespace smelt
