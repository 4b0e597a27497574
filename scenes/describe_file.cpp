#include "scenes/describe_file.h"

#include "core/error.h"
#include "core/geometry/manifold.h"
#include "io/atomic_file.h"
#include "io/checkpoint.h"
#include "io/extension.h"
#include "io/mesh_import.h"
#include "io/obj.h"
#include "io/particle_cloud.h"
#include "io/particles_vdb.h"
#include "io/ply_header.h"
#include "io/vdb_summary.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

namespace smelt {

namespace {

std::string describe_bounds(const Box3& b) {
  if (b.empty()) return "bounds     none\n";
  return fmt::format("bounds     ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}) m\n", b.lower[0], b.lower[1],
                     b.lower[2], b.upper[0], b.upper[1], b.upper[2]);
}

template <typename T>
std::string describe_values(const char* name, const char* unit, const std::vector<T>& values) {
  if (values.empty()) return fmt::format("{:<10} none\n", name);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return fmt::format("{:<10} {:.6g} to {:.6g} {}\n", name, *low, *high, unit);
}

std::string describe_fields(const ParticleFrame& p) {
  Box3 bounds;
  std::vector<float> speed;
  for (const Vec3& x : p.position) bounds.extend(x);
  for (const Vec3f& v : p.velocity) speed.push_back(v.norm());
  return describe_bounds(bounds) + describe_values("speed", "m/s", speed) +
         describe_values("density", "kg/m3", p.density) + describe_values("temperature", "K", p.temperature) +
         describe_values("viscosity", "Pa s", p.viscosity) +
         (p.rest.empty() ? "" : "rest       where each particle was before it moved\n");
}

std::string describe_particles(const std::filesystem::path& path) {
  const ParticleFrame p = read_particles(path);
  double volume = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) volume += p.mass_of(i) / static_cast<double>(p.density[i]);
  return fmt::format(
             "particles  {}\nframe      {} at {:.6g} s\nspacing    {:.6g} m, smoothing length {:.6g} m, mass {:.6g} kg "
             "each\nvolume     {:.6g} m3\n",
             p.size(), p.frame, p.time, p.spacing, p.smoothing_length, p.mass, volume) +
         describe_fields(p);
}

std::string describe_cloud(const std::filesystem::path& path) {
  ParticleCloud c = read_particle_cloud(path);
  ParticleFrame p;
  p.position = std::move(c.position);
  p.velocity = std::move(c.velocity);
  p.density = std::move(c.density);
  p.temperature = std::move(c.temperature);
  p.viscosity = std::move(c.viscosity);
  return fmt::format("particles  {}\n", p.size()) + describe_fields(p) +
         (c.unused.empty() ? std::string() : fmt::format("unused     {}\n", fmt::join(c.unused, ", ")));
}

std::string describe_grids(const std::vector<GridSummary>& grids) {
  std::string text = fmt::format("grids      {}\n", grids.size());
  for (const GridSummary& g : grids) {
    text += fmt::format("\ngrid       {}\ntype       {}, {}\nvoxels     {} active, {:.6g} m\n", g.name, g.value_type,
                        g.grid_class, g.n_active, g.voxel_size);
    if (g.grid_class == "level set")
      text += fmt::format("half width {:.6g} m, {:.3g} voxels\n", g.background, g.background / g.voxel_size);
    if (!g.bounds.empty()) text += describe_bounds(g.bounds);
    for (const auto& [name, value] : g.metadata) text += fmt::format("{:<10} {}\n", name, value);
  }
  return text;
}

std::string describe_vdb(const std::filesystem::path& path) {
  const std::vector<GridSummary> grids = summarise_vdb(path);
  // Other programs too call their particles so.
  const bool is_ours =
      std::any_of(grids.begin(), grids.end(), [](const GridSummary& g) { return g.name == "points" && g.is_of_smelt; });
  return is_ours ? describe_particles(path) : describe_grids(grids);
}

std::string describe_mesh(const TriangleMesh& mesh) {
  const MeshTopology t = compute_topology(mesh);
  const std::size_t n_pinched = count_nonmanifold_vertices(mesh);
  const std::string closed = t.n_boundary_edges == 0 ? "yes" : fmt::format("no: {} boundary edges", t.n_boundary_edges);
  const bool is_manifold = t.n_nonmanifold_edges == 0 && n_pinched == 0 && t.n_degenerate_faces == 0;
  const std::string manifold =
      is_manifold ? "yes"
                  : fmt::format("no: {} edges of more than two faces, {} pinched vertices, {} degenerate faces",
                                t.n_nonmanifold_edges, n_pinched, t.n_degenerate_faces);
  const std::string oriented = t.n_misoriented_edges == 0
                                   ? "yes"
                                   : fmt::format("no: {} edges run through the same way twice", t.n_misoriented_edges);
  return fmt::format(
             "vertices   {}\ntriangles  {}\ncomponents {}\nEuler      {}\nclosed     {}\nmanifold   {}\noriented   {}\n"
             "volume     {}\narea       {:.6g} m2\n",
             mesh.vertices.size(), mesh.triangles.size(), t.n_components, t.euler_characteristic, closed, manifold,
             oriented, t.closed() ? fmt::format("{:.6g} m3", compute_volume(mesh)) : "none, as it is not closed",
             compute_area(mesh)) +
         describe_bounds(compute_bounds(mesh));
}

std::string describe_checkpoint(const std::filesystem::path& path) {
  const Checkpoint c = read_checkpoint(path);
  return fmt::format("checkpoint of frame {} at {:.6g} s, {} particles\n", c.frame, c.time, c.particles.size());
}

/// Whether a PLY file is a mesh; other particle clouds never are.
bool has_faces(const std::filesystem::path& path) {
  if (lower_case_extension(path) != ".ply") return false;
  const PlyHeader header = read_ply_header(path, read_file(path));
  return std::any_of(header.elements.begin(), header.elements.end(),
                     [](const PlyElement& e) { return e.name == "face" && e.count > 0; });
}

}  // namespace

std::string describe_file(const std::filesystem::path& path) {
  const std::string extension = lower_case_extension(path);
  if (extension == ".vdb") return describe_vdb(path);
  if (is_particle_cloud(path) && !has_faces(path)) return describe_cloud(path);
  if (extension == ".bin") return describe_checkpoint(path);
  if (extension == ".obj" && is_empty_surface(path))
    return "vertices   0\ntriangles  0\nsurface    of a frame without particles, as smelt writes it\n";
  return describe_mesh(import_mesh(path));
}

}  // namespace smelt
