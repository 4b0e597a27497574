#include "io/ply.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/obj.h"
#include "io/particle_cloud.h"
#include "tests/meshes.h"

#include <assimp/Importer.hpp>
#include <assimp/scene.h>
#include <gtest/gtest.h>

#include <limits>
#include <unistd.h>

namespace smelt {
namespace {

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / ("ply_" + std::to_string(::getpid()) + "_" + name);
}

SurfaceMesh make_surface() {
  SurfaceMesh s;
  s.mesh = make_sphere({0.1, 0.2, 0.3}, 0.7, 3);
  for (const Vec3& x : s.mesh.vertices) {
    s.normals.push_back((x - Vec3(0.1, 0.2, 0.3)).normalized().cast<float>());
    s.velocity.push_back(Vec3f(1.0f, -2.0f, static_cast<float>(x[2])));
    s.temperature.push_back(300.0f + static_cast<float>(x[1]));
    s.viscosity.push_back(2.5f);
  }
  return s;
}

TEST(Ply, HoldsEveryAttribute) {
  const SurfaceMesh s = make_surface();
  write_ply(temporary("all.ply"), s);
  const ParticleCloud back = read_particle_cloud(temporary("all.ply"));
  ASSERT_EQ(back.position.size(), s.mesh.vertices.size());
  for (std::size_t v = 0; v < back.position.size(); ++v)
    ASSERT_EQ(back.position[v], s.mesh.vertices[v].cast<float>().cast<double>());
  EXPECT_EQ(back.velocity, s.velocity);
  EXPECT_EQ(back.temperature, s.temperature);
  EXPECT_EQ(back.viscosity, s.viscosity);
  EXPECT_EQ(back.unused, (std::vector<std::string>{"nx", "ny", "nz"}));
}

/// What assimp makes of a file: no step of its own between the file and its arrays.
TEST(Ply, AssimpReadsTheMeshAndItsNormals) {
  const SurfaceMesh s = make_surface();
  write_ply(temporary("assimp.ply"), s);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(temporary("assimp.ply").string(), 0);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  ASSERT_EQ(scene->mNumMeshes, 1u);
  const aiMesh& mesh = *scene->mMeshes[0];
  ASSERT_EQ(mesh.mNumVertices, s.mesh.vertices.size());
  ASSERT_EQ(mesh.mNumFaces, s.mesh.triangles.size());
  ASSERT_TRUE(mesh.HasNormals());
  for (unsigned v = 0; v < mesh.mNumVertices; ++v)
    for (unsigned a = 0; a < 3; ++a) {
      ASSERT_EQ(mesh.mVertices[v][a], static_cast<float>(s.mesh.vertices[v][a]));
      ASSERT_EQ(mesh.mNormals[v][a], s.normals[v][a]);
    }
}

TEST(Obj, AssimpReadsVertexColours) {
  const SurfaceMesh s = make_surface();
  std::vector<Vec3f> colours;
  for (const Vec3f& n : s.normals) colours.push_back(n.cwiseAbs());
  write_obj(temporary("colours.obj"), s, colours);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(temporary("colours.obj").string(), 0);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  const aiMesh& mesh = *scene->mMeshes[0];
  ASSERT_TRUE(mesh.HasVertexColors(0));
  // The reader makes a vertex of each corner: compare through the faces.
  for (unsigned f = 0; f < mesh.mNumFaces; ++f)
    for (unsigned i = 0; i < 3; ++i) {
      const aiColor4D& c = mesh.mColors[0][mesh.mFaces[f].mIndices[i]];
      const Vec3f& wanted = colours[s.mesh.triangles[f][i]];
      ASSERT_NEAR((Vec3f(c.r, c.g, c.b) - wanted).norm(), 0.0f, 1e-3f);
    }
  EXPECT_EQ(read_obj(temporary("colours.obj")).mesh.triangles, s.mesh.triangles) << "and we read it too";
}

TEST(Ply, RefusesWhatIsNotFinite) {
  SurfaceMesh s = make_surface();
  s.velocity[5][1] = std::numeric_limits<float>::infinity();
  EXPECT_THROW(write_ply(temporary("bad.ply"), s), Error);
  EXPECT_FALSE(std::filesystem::exists(temporary("bad.ply")));
}

}  // namespace
}  // namespace smelt
