#include "surfacing/cell_deciders.h"

#include "core/error.h"

#include <bit>
#include <cmath>

namespace smelt {

namespace {

/// Value at height z on the four edges along z, over corners 0 (A), 1 (B), 3 (C), 2 (D): A and C are diagonal.
struct Slice {
  std::array<double, 4> value;
};
constexpr std::array<int, 4> slice_corner = {0, 1, 3, 2};

Slice slice_at(const CellSamples& f, double z) {
  Slice s;
  for (int i = 0; i < 4; ++i) {
    const double low = f[slice_corner[i]], high = f[slice_corner[i] + 4];
    s.value[i] = low + z * (high - low);
  }
  return s;
}

/// Region of the cell's boundary that holds the point at height z on vertical edge i, known to be inside or outside.
int region_on_edge(const CellSamples& f, const CellCase& cell, int i, bool inside) {
  const int low = slice_corner[i], high = low + 4;
  return (f[low] >= 0.0f) == inside ? cell.region[low] : cell.region[high];
}

int loop_between(const CellCase& cell, int region_a, int region_b) {
  for (std::size_t l = 0; l < cell.loops.size(); ++l) {
    const auto [a, b] = edge_corners(cell.loops[l].front());
    const int p = cell.region[a], q = cell.region[b];
    if ((p == region_a && q == region_b) || (p == region_b && q == region_a)) return static_cast<int>(l);
  }
  return -1;
}

const CellTunnel* tunnel_between(const CellCase& cell, int region_a, int region_b) {
  // The two regions are neighbours of one region between them; its loops with either are the ends of the tube.
  for (const CellTunnel& t : cell.tunnels)
    for (int middle = 0; middle < 8; ++middle) {
      if (cell.region[middle] != middle) continue;
      const int a = loop_between(cell, region_a, middle), b = loop_between(cell, region_b, middle);
      if ((a == t.first && b == t.second) || (a == t.second && b == t.first)) return &t;
    }
  CHECK(!"a tube between regions that no common neighbour separates");
  return nullptr;
}

/// The tube that the saddle in the slice at height z makes, if it does.
const CellTunnel* tunnel_of_saddle(const CellSamples& f, const CellCase& cell, double z) {
  const auto [a, b, c, d] = slice_at(f, z).value;
  const bool ac_inside = a > 0.0 && c > 0.0 && b < 0.0 && d < 0.0;
  const bool bd_inside = b > 0.0 && d > 0.0 && a < 0.0 && c < 0.0;
  if (!ac_inside && !bd_inside) return nullptr;  // the saddle lies outside the cell
  const int a_region = region_on_edge(f, cell, 0, ac_inside), c_region = region_on_edge(f, cell, 2, ac_inside);
  const int b_region = region_on_edge(f, cell, 1, bd_inside), d_region = region_on_edge(f, cell, 3, bd_inside);
  if (a_region != c_region) return tunnel_between(cell, a_region, c_region);
  if (b_region != d_region) return tunnel_between(cell, b_region, d_region);
  return nullptr;
}

}  // namespace

std::uint8_t decide_faces(const CellSamples& sample, std::uint8_t ambiguous_faces) {
  unsigned joined = 0;
  for (unsigned faces = ambiguous_faces; faces != 0; faces &= faces - 1) {
    const int f = std::countr_zero(faces);
    const auto c = face_corners(f);
    const double one = static_cast<double>(sample[c[0]]) * static_cast<double>(sample[c[3]]);
    const double other = static_cast<double>(sample[c[1]]) * static_cast<double>(sample[c[2]]);
    const bool is_joined = sample[c[0]] >= 0.0f ? one >= other : other >= one;
    joined |= static_cast<unsigned>(is_joined) << f;
  }
  return static_cast<std::uint8_t>(joined);
}

const CellTunnel* find_tunnel(const CellSamples& sample, const CellCase& cell) {
  if (cell.tunnels.empty()) return nullptr;
  // A C - B D = p + q z + r z^2
  const auto [a, b, c, d] = slice_at(sample, 0.0).value;
  const auto [a1, b1, c1, d1] = slice_at(sample, 1.0).value;
  const double p = a * c - b * d;
  const double r = (a1 - a) * (c1 - c) - (b1 - b) * (d1 - d);
  const double q = a * (c1 - c) + c * (a1 - a) - b * (d1 - d) - d * (b1 - b);
  const double discriminant = q * q - 4.0 * p * r;
  if (!(discriminant > 0.0)) return nullptr;
  // Both roots without cancellation; one may be infinite, and is then outside the cell.
  const double t = -0.5 * (q + std::copysign(std::sqrt(discriminant), q));
  for (const double z : {t / r, p / t}) {
    if (!(z > 0.0 && z < 1.0)) continue;
    if (const CellTunnel* tunnel = tunnel_of_saddle(sample, cell, z)) return tunnel;
  }
  return nullptr;
}

}  // namespace smelt
