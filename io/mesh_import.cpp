#include "io/mesh_import.h"

#include "core/error.h"
#include "io/extension.h"
#include "io/ply_check.h"

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace smelt {
namespace {

const std::array<std::string_view, 6> extensions = {".obj", ".ply", ".stl", ".off", ".gltf", ".glb"};

void check_file(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) fail("{}: there is no such file; check the path", path.string());
  if (!std::filesystem::is_regular_file(path, error)) fail("{}: is not a file; name a mesh file", path.string());
  const std::string extension = lower_case_extension(path);
  if (std::find(extensions.begin(), extensions.end(), extension) == extensions.end())
    fail("{}: meshes cannot be read from '{}' files; allowed are {}", path.string(), extension,
         fmt::join(extensions, " "));
  if (std::filesystem::file_size(path, error) == 0 || error)
    fail("{}: the file is empty or cannot be read; export the mesh again", path.string());
}

/// Looks at the scene as loaded, while faces still have the numbers that they have in the file. assimp's later steps
/// abort the program on some of what is refused here.
void check_scene(const std::filesystem::path& path, const aiScene& scene) {
  std::size_t n_faces_before = 0;
  for (const aiMesh* part : std::span(scene.mMeshes, scene.mNumMeshes)) {
    for (std::size_t f = 0; f < part->mNumFaces; ++f) {
      const aiFace& face = part->mFaces[f];
      const std::size_t number = n_faces_before + f + 1;
      if (face.mNumIndices == 0)
        fail("{}: face {} has no corners: the file is truncated; export the mesh again", path.string(), number);
      for (const unsigned v : std::span(face.mIndices, face.mNumIndices)) {
        if (v >= part->mNumVertices)
          fail("{}: face {} refers to vertex {}; there are {}; export the mesh again", path.string(), number, v + 1,
               part->mNumVertices);
        if (const aiVector3D& p = part->mVertices[v]; !std::isfinite(p.x + p.y + p.z))
          fail("{}: face {} has a vertex at ({}, {}, {}); coordinates must be finite numbers", path.string(), number,
               p.x, p.y, p.z);
      }
    }
    n_faces_before += part->mNumFaces;
  }
}

/// Adds the meshes of `node` and of the nodes below it, moved to the world.
void append_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& world_from_parent, TriangleMesh& mesh) {
  const aiMatrix4x4 world_from_node = world_from_parent * node.mTransformation;
  // A mirror turns faces inside out.
  const bool mirrored = world_from_node.Determinant() < 0.0f;
  for (const unsigned m : std::span(node.mMeshes, node.mNumMeshes)) {
    const aiMesh& part = *scene.mMeshes[m];
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const aiVector3D& v : std::span(part.mVertices, part.mNumVertices)) {
      const aiVector3D p = world_from_node * v;
      mesh.vertices.emplace_back(p.x, p.y, p.z);
    }
    for (const aiFace& face : std::span(part.mFaces, part.mNumFaces)) {
      if (face.mNumIndices != 3) continue;
      std::array<std::uint32_t, 3> t = {first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]};
      if (mirrored) std::swap(t[1], t[2]);
      mesh.triangles.push_back(t);
    }
  }
  for (const aiNode* child : std::span(node.mChildren, node.mNumChildren))
    append_node(scene, *child, world_from_node, mesh);
}

TriangleMesh load(const std::filesystem::path& path) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile(path.string(), 0);
  if (scene) {
    check_scene(path, *scene);
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_SortByPType);
  }
  if (!scene || !scene->mRootNode) throw std::runtime_error(importer.GetErrorString());
  TriangleMesh mesh;
  append_node(*scene, *scene->mRootNode, aiMatrix4x4(), mesh);
  return mesh;
}

/// The mesh without the vertices that no face uses, which may be anywhere, even nowhere (nan).
TriangleMesh without_loose_vertices(const TriangleMesh& mesh) {
  constexpr std::uint32_t unused = 0xffffffff;
  std::vector<std::uint32_t> new_index(mesh.vertices.size(), unused);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) new_index[v] = 0;
  TriangleMesh out;
  for (std::size_t v = 0; v < new_index.size(); ++v)
    if (new_index[v] != unused) {
      new_index[v] = static_cast<std::uint32_t>(out.vertices.size());
      out.vertices.push_back(mesh.vertices[v]);
    }
  for (const auto& t : mesh.triangles) out.triangles.push_back({new_index[t[0]], new_index[t[1]], new_index[t[2]]});
  return out;
}

}  // namespace

TriangleMesh import_mesh(const std::filesystem::path& path) {
  check_file(path);
  if (lower_case_extension(path) == ".ply") check_ply(path);
  TriangleMesh mesh;
  try {
    mesh = without_loose_vertices(load(path));
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    fail("{}: cannot be read: {}; export the mesh again", path.string(), e.what());
  }
  if (mesh.triangles.empty()) fail("{}: has no faces; a body needs a closed surface", path.string());
  return weld(mesh, 1e-7 * compute_bounds(mesh).extent().norm());
}

}  // namespace smelt
