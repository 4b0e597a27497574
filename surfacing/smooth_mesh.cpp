#include "surfacing/smooth_mesh.h"

#include "core/error.h"
#include "surfacing/mesh_adjacency.h"

#include <Eigen/Geometry>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

constexpr float step = 0.8f;
constexpr std::size_t grain = 2048;

template <typename Body>
void for_each_vertex(std::size_t n, Body&& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, grain), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t v = range.begin(); v != range.end(); ++v) body(v);
  });
}

/// mean of neighbours - own value
template <typename Vector>
Vector umbrella(const VertexNeighbours& near, const std::vector<Vector>& x, std::size_t v) {
  Vector sum = Vector::Zero();
  for (std::uint32_t n = near.begin[v]; n < near.begin[v + 1]; ++n) sum += x[near.neighbour[n]];
  using Scalar = typename Vector::Scalar;
  return sum / static_cast<Scalar>(near.begin[v + 1] - near.begin[v]) - x[v];
}

/// x += G-steps of x, with a constant source added to the umbrella: source + L x.
void apply_steps(std::vector<Vec3f>& x, const std::vector<Vec3f>* source, const VertexNeighbours& near,
                 std::span<const float> strength, int passes) {
  std::vector<Vec3f> next(x.size());
  for (int pass = 0; pass < passes; ++pass) {
    for_each_vertex(x.size(), [&](std::size_t v) {
      Vec3f change = umbrella(near, x, v);
      if (source) change += (*source)[v];
      next[v] = x[v] + step * strength[v] * change;
    });
    std::swap(x, next);
  }
}

/// Of each piece, in the order of faces: signed volume, the area that moves, and the mean length of an edge.
struct Measures {
  std::vector<double> volume, area, edge;
};

Measures measure(const TriangleMesh& mesh, const MeshComponents& pieces, std::span<const float> strength) {
  Measures out{std::vector<double>(pieces.count), std::vector<double>(pieces.count), std::vector<double>(pieces.count)};
  std::vector<double> n_faces(pieces.count);
  const Vec3 origin = mesh.vertices.front();
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - origin, b = mesh.vertices[t[1]] - origin, c = mesh.vertices[t[2]] - origin;
    const std::uint32_t piece = pieces.of_vertex[t[0]];
    out.volume[piece] += a.dot(b.cross(c)) / 6.0;
    out.area[piece] += (b - a).cross(c - a).norm() / 6.0 * (strength[t[0]] + strength[t[1]] + strength[t[2]]);
    out.edge[piece] += ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 3.0;
    n_faces[piece] += 1.0;
  }
  for (std::size_t p = 0; p < pieces.count; ++p) out.edge[p] /= std::max(1.0, n_faces[p]);
  return out;
}

/// Newton's method on the shift of each piece along its normals: d volume / d shift = area. Small pieces that shrank a
/// lot overshoot at first, hence up to 8 rounds; large ones are done after one. A vertex moves by no more than half an edge a round: where
/// little of a piece is smoothed that little cannot give back all the volume, and must not fly off in trying.
void restore_volumes(TriangleMesh& mesh, const MeshComponents& pieces, std::span<const float> strength,
                     const std::vector<double>& volume) {
  for (int round = 0; round < 8; ++round) {
    const Measures now = measure(mesh, pieces, strength);
    std::vector<double> shift(pieces.count, 0.0);
    bool done = true;
    for (std::size_t p = 0; p < shift.size(); ++p) {
      const double missing = volume[p] - now.volume[p];
      if (std::abs(missing) <= 1e-5 * std::abs(volume[p]) || now.area[p] <= 0.0) continue;
      const double most = 0.5 * now.edge[p];  // strengths are 1 at most
      shift[p] = std::clamp(missing / now.area[p], -most, most);
      done = false;
    }
    if (done) return;
    const std::vector<Vec3f> normals = compute_vertex_normals(mesh);
    for_each_vertex(mesh.vertices.size(), [&](std::size_t v) {
      mesh.vertices[v] += shift[pieces.of_vertex[v]] * strength[v] * normals[v].cast<double>();
    });
  }
}

}  // namespace

void smooth_mesh(TriangleMesh& mesh, std::span<const float> strength, int passes) {
  CHECK_EQ(strength.size(), mesh.vertices.size());
  if (passes == 0 || mesh.vertices.empty()) return;
  const MeshComponents pieces = find_components(mesh);
  const Measures before = measure(mesh, pieces, strength);
  const VertexNeighbours near = find_vertex_neighbours(mesh);

  // Everything runs on displacements from the start, which are short: single precision then costs nothing at any
  // distance from the origin.
  const std::size_t n = mesh.vertices.size();
  std::vector<Vec3f> curvature(n), first(n, Vec3f::Zero()), second(n);
  for_each_vertex(n, [&](std::size_t v) { curvature[v] = umbrella(near, mesh.vertices, v).cast<float>(); });
  apply_steps(first, &curvature, near, strength, passes);  // G x - x
  for (std::size_t v = 0; v < n; ++v) second[v] = -first[v];
  apply_steps(second, nullptr, near, strength, passes);  // G (x - G x)
  for_each_vertex(n, [&](std::size_t v) { mesh.vertices[v] += (first[v] + second[v]).cast<double>(); });

  restore_volumes(mesh, pieces, strength, before.volume);
}

std::vector<Vec3f> compute_vertex_normals(const TriangleMesh& mesh) {
  std::vector<Vec3f> normals(mesh.vertices.size(), Vec3f::Zero());
  for (const auto& t : mesh.triangles) {
    const Vec3& a = mesh.vertices[t[0]];
    const Vec3f n = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).cast<float>();
    for (const std::uint32_t v : t) normals[v] += n;
  }
  for (Vec3f& n : normals) n.normalize();
  return normals;
}

}  // namespace smelt
