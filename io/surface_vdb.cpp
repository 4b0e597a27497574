#include "io/surface_vdb.h"

#include "core/error.h"
#include "core/geometry/narrow_band.h"
#include "io/obj.h"
#include "io/vdb_file.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/parallel_for.h>

#include <atomic>

namespace smelt {
namespace {

/// Voxels on either side of the surface. Trilinear sampling on the surface reaches sqrt(3) voxels.
constexpr float half_width = 3.0f;

openvdb::Vec3f to_vdb(const Vec3f& v) {
  return {v.x(), v.y(), v.z()};
}
float to_vdb(float x) {
  return x;
}

/// A grid whose active voxels are those of the band; `value_at(block, voxel)` gives their values.
template <typename Grid, typename ValueAt>
typename Grid::Ptr make_grid(const std::vector<BandBlock>& band, const typename Grid::ValueType& background,
                             ValueAt value_at) {
  using Leaf = typename Grid::TreeType::LeafNodeType;
  std::vector<Leaf*> leaves(band.size());
  tbb::parallel_for(std::size_t{0}, band.size(), [&](std::size_t b) {
    leaves[b] = new Leaf(openvdb::Coord(band[b].origin.data()), background);
    for (openvdb::Index voxel = 0; voxel < Leaf::SIZE; ++voxel)
      if (band[b].face[voxel] != BandBlock::outside_band) leaves[b]->setValueOn(voxel, value_at(band[b], voxel));
  });
  const auto grid = Grid::create(background);
  for (Leaf* leaf : leaves) grid->tree().addLeaf(leaf);
  return grid;
}

openvdb::FloatGrid::Ptr make_level_set(const std::vector<BandBlock>& band, float voxel_size) {
  const auto grid = make_grid<openvdb::FloatGrid>(
      band, half_width * voxel_size,
      [&](const BandBlock& block, std::size_t voxel) { return block.distance[voxel] * voxel_size; });
  openvdb::tools::signedFloodFill(grid->tree());
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

/// 1 inside, 0 outside, a ramp as wide as the band inside the surface.
openvdb::FloatGrid::Ptr make_fog_volume(const openvdb::FloatGrid& level_set) {
  const openvdb::FloatGrid::Ptr fog = level_set.deepCopy();
  openvdb::tools::sdfToFogVolume(*fog);
  fog->clearMetadata();
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  return fog;
}

/// A vertex field, interpolated at the nearest point of the surface.
template <typename Grid, typename Value>
typename Grid::Ptr make_field(const std::vector<BandBlock>& band, const TriangleMesh& mesh,
                              const std::vector<Value>& at_vertex) {
  CHECK_EQ(at_vertex.size(), mesh.vertices.size());
  return make_grid<Grid>(
      band, openvdb::zeroVal<typename Grid::ValueType>(), [&](const BandBlock& block, std::size_t voxel) {
        const auto& corners = mesh.triangles[static_cast<std::size_t>(block.face[voxel])];
        const auto [v, w] = block.w[voxel];
        const Value value =
            (1.0f - v - w) * at_vertex[corners[0]] + v * at_vertex[corners[1]] + w * at_vertex[corners[2]];
        return to_vdb(value);
      });
}

/// The grid called `name`, or null.
template <typename Grid>
typename Grid::Ptr find_grid(const openvdb::GridPtrVec& grids, const std::string& name) {
  for (const auto& grid : grids)
    if (grid->getName() == name) return openvdb::gridPtrCast<Grid>(grid);
  return nullptr;
}

/// Trilinear samples at the vertices.
template <typename Grid>
std::vector<typename Grid::ValueType> sample_at_vertices(const Grid& grid, const TriangleMesh& mesh,
                                                         const std::filesystem::path& path) {
  std::vector<typename Grid::ValueType> values(mesh.vertices.size());
  std::atomic<std::size_t> n_outside = 0;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.vertices.size(), 1024), [&](const auto& range) {
    const auto accessor = grid.getConstAccessor();
    for (std::size_t v = range.begin(); v < range.end(); ++v) {
      const Vec3& x = mesh.vertices[v];
      const openvdb::Vec3d at = grid.worldToIndex(openvdb::Vec3d(x.x(), x.y(), x.z()));
      if (!openvdb::tools::BoxSampler::sample(accessor, at, values[v])) ++n_outside;
    }
  });
  if (n_outside > 0)
    fail(
        "{}: {} of {} vertices of the surface lie outside the grid `{}`: the .obj and .vdb files are not of the same "
        "frame; write both again",
        path.string(), n_outside.load(), mesh.vertices.size(), grid.getName());
  return values;
}

}  // namespace

void write_surface_vdb(const std::filesystem::path& path, const SurfaceMesh& surface, double voxel_size,
                       std::int32_t frame, double time, bool fog_volume) {
  const std::vector<BandBlock> band = compute_narrow_band(surface.mesh, voxel_size, half_width);

  // One grid per field that the surface has.
  openvdb::GridPtrVec grids;
  const auto add = [&](const openvdb::GridBase::Ptr& grid, const std::string& name) {
    grid->setName(name);
    grids.push_back(grid);
  };
  const openvdb::FloatGrid::Ptr level_set = make_level_set(band, static_cast<float>(voxel_size));
  add(level_set, "surface");
  const auto velocity = make_field<openvdb::Vec3SGrid>(band, surface.mesh, surface.velocity);
  velocity->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
  add(velocity, "v");
  if (!surface.temperature.empty())
    add(make_field<openvdb::FloatGrid>(band, surface.mesh, surface.temperature), "temperature");
  if (!surface.viscosity.empty())
    add(make_field<openvdb::FloatGrid>(band, surface.mesh, surface.viscosity), "viscosity");
  if (!surface.rest.empty()) add(make_field<openvdb::Vec3SGrid>(band, surface.mesh, surface.rest), "rest");

  for (const auto& grid : grids) grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel_size));
  level_set->insertMeta("half_width_voxels", openvdb::FloatMetadata(half_width));
  if (fog_volume) add(make_fog_volume(*level_set), "density");
  for (const auto& grid : grids) {
    grid->setCreator("smelt");
    grid->insertMeta("frame", openvdb::Int32Metadata(frame));
    grid->insertMeta("time", openvdb::DoubleMetadata(time));
  }
  write_vdb(path, openvdb::GridCPtrVec(grids.begin(), grids.end()));
}

SurfaceMesh read_surface(const std::filesystem::path& obj_path, const std::filesystem::path& vdb_path) {
  SurfaceMesh surface = read_obj(obj_path);
  const openvdb::GridPtrVec grids = read_vdb(vdb_path);
  const auto velocity = find_grid<openvdb::Vec3SGrid>(grids, "v");
  if (!velocity) fail("{}: has no vector grid `v`; only surface files written by smelt can be read", vdb_path.string());
  const auto vectors_of = [&](const openvdb::Vec3SGrid& grid) {
    std::vector<Vec3f> values;
    for (const openvdb::Vec3f& v : sample_at_vertices(grid, surface.mesh, vdb_path))
      values.emplace_back(v.x(), v.y(), v.z());
    return values;
  };
  surface.velocity = vectors_of(*velocity);
  if (const auto grid = find_grid<openvdb::FloatGrid>(grids, "temperature"))
    surface.temperature = sample_at_vertices(*grid, surface.mesh, vdb_path);
  if (const auto grid = find_grid<openvdb::FloatGrid>(grids, "viscosity"))
    surface.viscosity = sample_at_vertices(*grid, surface.mesh, vdb_path);
  if (const auto grid = find_grid<openvdb::Vec3SGrid>(grids, "rest")) surface.rest = vectors_of(*grid);
  return surface;
}

}  // namespace smelt
