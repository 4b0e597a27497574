#include "scenes/describe_file.h"

#include "core/error.h"
#include "core/geometry/triangle_mesh.h"
#include "io/checkpoint.h"
#include "io/mesh_import.h"
#include "io/particles_vdb.h"

#include <algorithm>

namespace smelt {

namespace {

std::string describe_bounds(const Box3& b) {
  return fmt::format("bounds     ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}) m\n", b.lower[0], b.lower[1], b.lower[2], b.upper[0],
                     b.upper[1], b.upper[2]);
}

template <typename T>
std::string describe_values(const char* name, const char* unit, const std::vector<T>& values) {
  if (values.empty()) return fmt::format("{:<10} none\n", name);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return fmt::format("{:<10} {:.6g} to {:.6g} {}\n", name, *low, *high, unit);
}

std::string describe_particles(const std::filesystem::path& path) {
  const ParticleFrame p = read_particles(path);
  Box3 bounds;
  std::vector<float> speed;
  for (const Vec3& x : p.position) bounds.extend(x);
  for (const Vec3f& v : p.velocity) speed.push_back(v.norm());
  return fmt::format("particles  {}\nframe      {} at {:.6g} s\nspacing    {:.6g} m, smoothing length {:.6g} m, mass {:.6g} kg each\n", p.size(),
                     p.frame, p.time, p.spacing, p.smoothing_length, p.mass) +
         describe_bounds(bounds) + describe_values("speed", "m/s", speed) + describe_values("density", "kg/m3", p.density) +
         describe_values("temperature", "K", p.temperature) + describe_values("viscosity", "Pa s", p.viscosity) +
         (p.rest.empty() ? "" : "rest       where each particle was before it moved\n");
}

std::string describe_mesh(const std::filesystem::path& path) {
  const TriangleMesh mesh = import_mesh(path);
  const MeshTopology t = compute_topology(mesh);
  std::string closed = "yes";
  if (!t.closed())
    closed = fmt::format("no: {} boundary, {} non-manifold, {} misoriented edges, {} degenerate faces", t.n_boundary_edges,
                         t.n_nonmanifold_edges, t.n_misoriented_edges, t.n_degenerate_faces);
  return fmt::format("vertices   {}\ntriangles  {}\ncomponents {}\nEuler      {}\nclosed     {}\nvolume     {:.6g} m3\narea       {:.6g} m2\n",
                     mesh.vertices.size(), mesh.triangles.size(), t.n_components, t.euler_characteristic, closed, compute_volume(mesh),
                     compute_area(mesh)) +
         describe_bounds(compute_bounds(mesh));
}

std::string describe_checkpoint(const std::filesystem::path& path) {
  const Checkpoint c = read_checkpoint(path);
  return fmt::format("checkpoint of frame {} at {:.6g} s, {} particles\n", c.frame, c.time, c.particles.size());
}

}  // namespace

std::string describe_file(const std::filesystem::path& path) {
  if (path.extension() == ".vdb") return describe_particles(path);
  if (path.extension() == ".bin") return describe_checkpoint(path);
  return describe_mesh(path);
}

}  // namespace smelt
