#include "io/particles_vdb.h"

#include "core/error.h"
#include "io/vdb_file.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointConversion.h>
#include <openvdb/points/PointCount.h>
#include <openvdb/tools/PointIndexGrid.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace smelt {
namespace {

namespace vp = openvdb::points;
using openvdb::Vec3d;

/// Indices of particles, ordered by id.
std::vector<std::size_t> order_by_id(const std::vector<std::int32_t>& id) {
  std::vector<std::size_t> order(id.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto by_id = [&](std::size_t a, std::size_t b) { return id[a] < id[b]; };
  if (!std::is_sorted(order.begin(), order.end(), by_id)) std::sort(order.begin(), order.end(), by_id);
  return order;
}

template <typename T>
std::vector<T> permuted(const std::vector<T>& values, const std::vector<std::size_t>& order) {
  std::vector<T> result;
  result.reserve(values.size());
  if (!values.empty())
    for (const std::size_t i : order) result.push_back(values[i]);
  return result;
}

void check_sizes(const ParticleFrame& p) {
  CHECK_GT(p.spacing, 0.0);
  CHECK_EQ(p.velocity.size(), p.size());
  CHECK_EQ(p.density.size(), p.size());
  CHECK_EQ(p.id.size(), p.size());
  if (!p.temperature.empty()) CHECK_EQ(p.temperature.size(), p.size());
  if (!p.viscosity.empty()) CHECK_EQ(p.viscosity.size(), p.size());
  if (!p.masses.empty()) CHECK_EQ(p.masses.size(), p.size());
  if (!p.rest.empty()) CHECK_EQ(p.rest.size(), p.size());
}

/// OpenVDB's vectors, in another order.
std::vector<openvdb::Vec3f> to_vdb_vectors(const std::vector<Vec3f>& values, const std::vector<std::size_t>& order) {
  std::vector<openvdb::Vec3f> result;
  result.reserve(values.size());
  if (!values.empty())
    for (const std::size_t i : order) result.emplace_back(values[i].x(), values[i].y(), values[i].z());
  return result;
}

/// World positions; refuses those that a voxel index cannot hold.
std::vector<Vec3d> to_vdb_positions(const ParticleFrame& p, const std::vector<std::size_t>& order, double voxel_size) {
  constexpr double furthest = 1 << 30;
  std::vector<Vec3d> positions;
  positions.reserve(p.size());
  for (const std::size_t i : order) {
    const Vec3& x = p.position[i];
    if (!((x / voxel_size).cwiseAbs().maxCoeff() < furthest))
      fail(
          "particle {} at ({}, {}, {}) m is too far out to be written: at most {:.4g} m are allowed; it has left the "
          "scene",
          p.id[i], x.x(), x.y(), x.z(), furthest * voxel_size);
    positions.emplace_back(x.x(), x.y(), x.z());
  }
  return positions;
}

/// Which points lie in which voxel; within a voxel by ascending index, whatever thread put them there.
openvdb::tools::PointIndexGrid::Ptr sort_into_voxels(const vp::PointAttributeVector<Vec3d>& positions,
                                                     const openvdb::math::Transform& transform) {
  const auto grid = openvdb::tools::createPointIndexGrid<openvdb::tools::PointIndexGrid>(positions, transform);
  for (auto leaf = grid->tree().beginLeaf(); leaf; ++leaf) {
    auto& indices = leaf->indices();
    std::size_t first = 0;
    for (openvdb::Index voxel = 0; voxel < leaf->NUM_VALUES; ++voxel) {
      const std::size_t last = leaf->getValue(voxel);
      std::sort(indices.begin() + static_cast<std::ptrdiff_t>(first),
                indices.begin() + static_cast<std::ptrdiff_t>(last));
      first = last;
    }
  }
  return grid;
}

template <typename T>
void add_attribute(vp::PointDataTree& tree, const openvdb::tools::PointIndexTree& index_tree, const std::string& name,
                   const std::vector<T>& values) {
  if (values.empty()) return;
  vp::appendAttribute(tree, name, vp::TypedAttributeArray<T>::attributeType());
  vp::populateAttribute<vp::PointDataTree, openvdb::tools::PointIndexTree, vp::PointAttributeVector<T>>(
      tree, index_tree, name, vp::PointAttributeVector<T>(values));
}

void add_metadata(openvdb::GridBase& grid, const ParticleFrame& p) {
  grid.setName("points");
  grid.setCreator("smelt");
  grid.insertMeta("frame", openvdb::Int32Metadata(p.frame));
  grid.insertMeta("time", openvdb::DoubleMetadata(p.time));
  grid.insertMeta("mass", openvdb::DoubleMetadata(p.mass));
  grid.insertMeta("spacing", openvdb::DoubleMetadata(p.spacing));
  grid.insertMeta("smoothing_length", openvdb::DoubleMetadata(p.smoothing_length));
}

/// A piece of metadata that write_particles puts into every file.
template <typename T>
T metadata_of(const openvdb::GridBase& grid, const std::string& name, const std::filesystem::path& path) {
  const auto meta = grid.getMetadata<openvdb::TypedMetadata<T>>(name);
  if (!meta)
    fail("{}: the grid `points` lacks the metadata `{}`; only particle files written by smelt can be read",
         path.string(), name);
  return meta->value();
}

/// The values of one attribute, leaf by leaf; empty where the file has none and `required` is false.
template <typename T>
std::vector<T> read_attribute(const std::vector<const vp::PointDataTree::LeafNodeType*>& leaves,
                              const std::vector<std::size_t>& first_of_leaf, const std::string& name, bool required,
                              const std::filesystem::path& path) {
  std::vector<T> values;
  if (leaves.empty()) return values;
  for (const auto* leaf : leaves) {
    if (leaf->attributeSet().find(name) != vp::AttributeSet::INVALID_POS) continue;
    if (!required) return values;
    fail("{}: the points lack the attribute `{}`; only particle files written by smelt can be read", path.string(),
         name);
  }
  if (const auto* array = leaves.front()->attributeSet().getConst(name);
      array->valueType() != openvdb::typeNameAsString<T>())
    fail("{}: the attribute `{}` of the points is of type {}, not {}; only particle files written by smelt can be read",
         path.string(), name, array->valueType(), openvdb::typeNameAsString<T>());
  values.resize(first_of_leaf.back());
  tbb::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t l) {
    const vp::AttributeHandle<T> handle(leaves[l]->constAttributeArray(name));
    for (std::size_t i = first_of_leaf[l]; i < first_of_leaf[l + 1]; ++i)
      values[i] = handle.get(static_cast<openvdb::Index>(i - first_of_leaf[l]));
  });
  return values;
}

/// Each point's position in its voxel, moved to the world.
std::vector<Vec3> read_positions(const vp::PointDataGrid& grid,
                                 const std::vector<const vp::PointDataTree::LeafNodeType*>& leaves,
                                 const std::vector<std::size_t>& first_of_leaf, const std::filesystem::path& path) {
  const auto in_voxel = read_attribute<openvdb::Vec3f>(leaves, first_of_leaf, "P", true, path);
  std::vector<Vec3> positions(in_voxel.size());
  tbb::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t l) {
    for (auto point = leaves[l]->beginIndexAll(); point; ++point) {
      const std::size_t i = first_of_leaf[l] + *point;
      const Vec3d x = grid.indexToWorld(point.getCoord().asVec3d() + Vec3d(in_voxel[i]));
      positions[i] = Vec3(x.x(), x.y(), x.z());
    }
  });
  return positions;
}

}  // namespace

void write_particles(const std::filesystem::path& path, const ParticleFrame& particles) {
  initialise_openvdb();
  check_sizes(particles);
  const std::vector<std::size_t> order = order_by_id(particles.id);
  const double voxel_size = 4.0 * particles.spacing;
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel_size);

  // Positions, which make the tree.
  const std::vector<Vec3d> positions = to_vdb_positions(particles, order, voxel_size);
  const vp::PointAttributeVector<Vec3d> position_list(positions);
  const auto index_grid = sort_into_voxels(position_list, *transform);
  const auto grid = vp::createPointDataGrid<vp::NullCodec, vp::PointDataGrid>(*index_grid, position_list, *transform);
  add_metadata(*grid, particles);

  // The other attributes.
  add_attribute(grid->tree(), index_grid->tree(), "v", to_vdb_vectors(particles.velocity, order));
  add_attribute(grid->tree(), index_grid->tree(), "density", permuted(particles.density, order));
  add_attribute(grid->tree(), index_grid->tree(), "temperature", permuted(particles.temperature, order));
  add_attribute(grid->tree(), index_grid->tree(), "viscosity", permuted(particles.viscosity, order));
  add_attribute(grid->tree(), index_grid->tree(), "mass", permuted(particles.masses, order));
  add_attribute(grid->tree(), index_grid->tree(), "rest", to_vdb_vectors(particles.rest, order));
  add_attribute(grid->tree(), index_grid->tree(), "id", permuted(particles.id, order));

  write_vdb(path, {grid});
}

ParticleFrame read_particles(const std::filesystem::path& path) {
  // Find the grid and number the points, leaf after leaf.
  vp::PointDataGrid::Ptr grid;
  for (const auto& candidate : read_vdb(path))
    if (candidate->getName() == "points") grid = openvdb::gridPtrCast<vp::PointDataGrid>(candidate);
  if (!grid)
    fail("{}: has no point grid named `points`; only particle files written by smelt can be read", path.string());
  std::vector<const vp::PointDataTree::LeafNodeType*> leaves;
  std::vector<std::size_t> first_of_leaf = {0};
  for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) {
    leaves.push_back(leaf.getLeaf());
    first_of_leaf.push_back(first_of_leaf.back() + leaf->pointCount());
  }

  ParticleFrame p;
  p.frame = metadata_of<std::int32_t>(*grid, "frame", path);
  p.time = metadata_of<double>(*grid, "time", path);
  p.mass = metadata_of<double>(*grid, "mass", path);
  p.spacing = metadata_of<double>(*grid, "spacing", path);
  p.smoothing_length = metadata_of<double>(*grid, "smoothing_length", path);
  p.id = read_attribute<std::int32_t>(leaves, first_of_leaf, "id", true, path);

  // All fields in the order of the ids.
  const std::vector<std::size_t> order = order_by_id(p.id);
  p.id = permuted(p.id, order);
  if (const auto twin = std::adjacent_find(p.id.begin(), p.id.end()); twin != p.id.end())
    fail("{}: two points have the id {}; the file is damaged, write it again", path.string(), *twin);
  p.position = permuted(read_positions(*grid, leaves, first_of_leaf, path), order);
  const auto read_vectors = [&](const std::string& name, bool required) {
    std::vector<Vec3f> values;
    for (const openvdb::Vec3f& v :
         permuted(read_attribute<openvdb::Vec3f>(leaves, first_of_leaf, name, required, path), order))
      values.emplace_back(v.x(), v.y(), v.z());
    return values;
  };
  p.velocity = read_vectors("v", true);
  p.rest = read_vectors("rest", false);
  const auto read_floats = [&](const std::string& name, bool required) {
    return permuted(read_attribute<float>(leaves, first_of_leaf, name, required, path), order);
  };
  p.density = read_floats("density", true);
  p.temperature = read_floats("temperature", false);
  p.viscosity = read_floats("viscosity", false);
  p.masses = read_floats("mass", false);
  return p;
}

}  // namespace smelt
