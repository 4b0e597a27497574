#include "assets/implicit_mesh.h"

#include "surfacing/lattice.h"
#include "surfacing/marching_cubes.h"
#include "surfacing/smooth_mesh.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

namespace smelt {

namespace {

constexpr int edge = SparseField::block_edge;
constexpr float iso = 1.0F;

/// All blocks that meet the box, and one layer around them.
SparseField make_blocks(const Box3& box, double cell) {
  SparseField field;
  field.cell = cell;
  Lattice low, high;
  for (int a = 0; a < 3; ++a) {
    low[a] = floor_to_int(box.lower[a] / (edge * cell)) - 1;
    high[a] = floor_to_int(box.upper[a] / (edge * cell)) + 1;
  }
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) field.key.push_back(lattice_key(x, y, z));
  field.value.assign(field.key.size() * SparseField::block_size, 0.0F);
  return field;
}

}  // namespace

TriangleMesh make_implicit_mesh(const std::function<double(const Vec3&)>& distance, const Box3& box, double cell,
                                int passes) {
  SparseField field = make_blocks(box, cell);
  tbb::parallel_for(std::size_t{0}, field.n_blocks(), [&](std::size_t block) {
    const Lattice p = lattice_from_key(field.key[block]);
    float* value = field.value.data() + block * SparseField::block_size;
    for (int k = 0; k < edge; ++k)
      for (int j = 0; j < edge; ++j)
        for (int i = 0; i < edge; ++i) {
          const Vec3 x = cell * Vec3(edge * p[0] + i, edge * p[1] + j, edge * p[2] + k);
          // Absent blocks read as 0, outside: so does everything a cell away.
          *value++ = iso + static_cast<float>(std::clamp(-distance(x) / cell, -1.0, 1.0));
        }
  });
  TriangleMesh mesh = extract_iso_surface(field, iso);
  smooth_mesh(mesh, find_vertex_neighbours(mesh), std::vector<float>(mesh.vertices.size(), 1.0F), passes);
  return mesh;
}

}  // namespace smelt
