#include "core/geometry/narrow_band.h"

#include "core/error.h"
#include "core/geometry/inside.h"

#include <Eigen/Geometry>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace smelt {
namespace {

using Triangle = std::array<Vec3, 3>;

/// The point a + v (b - a) + w (c - a) of a triangle that is nearest to `p`. [Ericson 2005, Real-Time Collision
/// Detection, 5.1.5]
std::pair<double, double> nearest_on_triangle(const Triangle& t, const Vec3& p) {
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0];
  const Vec3 ap = p - t[0], bp = p - t[1], cp = p - t[2];
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp), d6 = ac.dot(cp);
  // The corners.
  if (d1 <= 0.0 && d2 <= 0.0) return {0.0, 0.0};
  if (d3 >= 0.0 && d4 <= d3) return {1.0, 0.0};
  if (d6 >= 0.0 && d5 <= d6) return {0.0, 1.0};
  // The edges. Where a denominator is zero, its edge is a point and a corner was nearest.
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {d1 / (d1 - d3), 0.0};
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {0.0, d2 / (d2 - d6)};
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {1.0 - w, w};
  }
  // The inside.
  const double sum = va + vb + vc;
  return {vb / sum, vc / sum};
}

/// A face that may be near the voxels of a block.
struct Reach {
  std::array<std::int32_t, 3> block;  ///< origin / 8
  std::uint32_t face;
  auto key() const { return std::tuple(block[0], block[1], block[2], face); }
};

std::int32_t voxel_of(double x) {
  constexpr double furthest = 1 << 28;
  if (!(std::abs(x) < furthest))
    fail(
        "a surface vertex lies {} voxels from the origin; at most {} are allowed: use a larger voxel, or look for "
        "particles that left the scene",
        x, furthest);
  return static_cast<std::int32_t>(x);
}

std::vector<Reach> collect_reaches(const TriangleMesh& mesh, float half_width) {
  std::vector<Reach> reaches;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    Box3 box;
    for (const std::uint32_t v : mesh.triangles[f]) box.extend(mesh.vertices[v]);
    std::array<std::int32_t, 3> first{}, last{};
    for (std::size_t k = 0; k < 3; ++k) {
      first[k] = voxel_of(std::ceil(box.lower[static_cast<int>(k)] - half_width)) >> 3;
      last[k] = voxel_of(std::floor(box.upper[static_cast<int>(k)] + half_width)) >> 3;
    }
    for (std::int32_t i = first[0]; i <= last[0]; ++i)
      for (std::int32_t j = first[1]; j <= last[1]; ++j)
        for (std::int32_t k = first[2]; k <= last[2]; ++k) reaches.push_back({{i, j, k}, f});
  }
  tbb::parallel_sort(reaches.begin(), reaches.end(), [](const Reach& a, const Reach& b) { return a.key() < b.key(); });
  return reaches;
}

/// Square of the distance between `x` and the interval [low, high].
double squared_gap(double x, double low, double high) {
  const double gap = std::max(std::max(low - x, x - high), 0.0);
  return gap * gap;
}

/// Lets one face compete for the voxels of a block. `best` holds squared distances, at first `limit`.
void offer_face(const Triangle& t, std::int32_t face, double limit, BandBlock& block, std::array<double, 512>& best) {
  constexpr std::size_t width = BandBlock::width;
  const Vec3 low = t[0].cwiseMin(t[1]).cwiseMin(t[2]), high = t[0].cwiseMax(t[1]).cwiseMax(t[2]);
  const Vec3 origin(block.origin[0], block.origin[1], block.origin[2]);
  std::array<std::array<double, width>, 3> gap{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < width; ++i) {
      const auto k = static_cast<int>(axis);
      gap[axis][i] = squared_gap(origin[k] + static_cast<double>(i), low[k], high[k]);
    }
  for (std::size_t i = 0; i < width; ++i) {
    if (gap[0][i] >= limit) continue;
    for (std::size_t j = 0; j < width; ++j) {
      if (gap[0][i] + gap[1][j] >= limit) continue;
      for (std::size_t k = 0; k < width; ++k) {
        // The face is no nearer than its bounds.
        const std::size_t voxel = i * 64 + j * 8 + k;
        if (gap[0][i] + gap[1][j] + gap[2][k] >= best[voxel]) continue;
        const Vec3 p = origin + Vec3(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
        const auto [v, w] = nearest_on_triangle(t, p);
        const double d2 = (t[0] + v * (t[1] - t[0]) + w * (t[2] - t[0]) - p).squaredNorm();
        if (!(d2 < best[voxel])) continue;
        best[voxel] = d2;
        block.face[voxel] = face;
        block.w[voxel] = {static_cast<float>(v), static_cast<float>(w)};
      }
    }
  }
}

/// Distances with their signs, row after row along x.
void set_distances(const InsideTest& inside, const std::array<double, 512>& best, BandBlock& block) {
  std::vector<Crossing> crossings;
  for (int j = 0; j < BandBlock::width; ++j)
    for (int k = 0; k < BandBlock::width; ++k) {
      inside.intersect(block.origin[1] + j, block.origin[2] + k, crossings);
      std::size_t next = 0;
      int winding = 0;
      for (int i = 0; i < BandBlock::width; ++i) {
        for (; next < crossings.size() && crossings[next].x < block.origin[0] + i; ++next)
          winding += crossings[next].winding;
        const auto voxel = static_cast<std::size_t>(i * 64 + j * 8 + k);
        const double d = std::sqrt(best[voxel]);
        block.distance[voxel] = static_cast<float>(winding != 0 ? -d : d);
      }
    }
}

}  // namespace

std::vector<BandBlock> compute_narrow_band(const TriangleMesh& mesh, double voxel_size, float half_width) {
  CHECK_GT(voxel_size, 0.0);
  TriangleMesh in_voxels = mesh;
  for (Vec3& v : in_voxels.vertices) v /= voxel_size;

  // Group the faces by the blocks that they may reach.
  const std::vector<Reach> reaches = collect_reaches(in_voxels, half_width);
  std::vector<std::size_t> first_of_block;
  for (std::size_t r = 0; r < reaches.size(); ++r)
    if (r == 0 || reaches[r].block != reaches[r - 1].block) first_of_block.push_back(r);
  const std::size_t n_blocks = first_of_block.size();
  first_of_block.push_back(reaches.size());

  const double limit = static_cast<double>(half_width) * half_width;

  // Each block by itself, faces in ascending order.
  const InsideTest inside(in_voxels, 1.0);
  std::vector<BandBlock> blocks(n_blocks);
  tbb::parallel_for(std::size_t{0}, n_blocks, [&](std::size_t b) {
    BandBlock& block = blocks[b];
    const auto& at = reaches[first_of_block[b]].block;
    block.origin = {8 * at[0], 8 * at[1], 8 * at[2]};
    block.face.fill(BandBlock::outside_band);
    std::array<double, 512> best;
    best.fill(limit);
    for (std::size_t r = first_of_block[b]; r < first_of_block[b + 1]; ++r) {
      const auto& corners = in_voxels.triangles[reaches[r].face];
      offer_face({in_voxels.vertices[corners[0]], in_voxels.vertices[corners[1]], in_voxels.vertices[corners[2]]},
                 static_cast<std::int32_t>(reaches[r].face), limit, block, best);
    }
    set_distances(inside, best, block);
  });
  std::erase_if(blocks, [](const BandBlock& block) {
    return std::all_of(block.face.begin(), block.face.end(),
                       [](std::int32_t f) { return f == BandBlock::outside_band; });
  });
  return blocks;
}

}  // namespace smelt
