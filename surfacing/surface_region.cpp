#include "surfacing/surface_region.h"

#include "core/error.h"
#include "core/parallel.h"
#include "surfacing/key_lists.h"

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

constexpr int edge = 8;  // nodes along a block
constexpr int spread =
    edge + 4;  // with one beyond it each way for the filter, and one more for the particles that reach that

using Window = std::array<float, spread * spread * spread>;

/// Keys of the blocks that hold a particle.
std::vector<std::uint64_t> find_blocks(const ParticleBins& bins, double node) {
  return collect_keys(bins.n_bins(), [&](std::size_t b, std::vector<std::uint64_t>& keys) {
    const Box3 box = bins.box(b);
    Lattice low, high;
    for (int a = 0; a < 3; ++a) {
      low[a] = floor_to_int(box.lower[a] / (node * edge));
      high[a] = floor_to_int(box.upper[a] / (node * edge));
    }
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int x = low[0]; x <= high[0]; ++x) keys.push_back(lattice_key(x, y, z));
  });
}

/// Spreads the volumes, in cells of a node, of the particles around a block; entry (0, 0, 0) is node (-2, -2, -2).
void spread_volumes(Window& out, const ParticleBins& bins, std::span<const float> volume, const Vec3& first,
                    double node) {
  out.fill(0.0f);
  const auto scale = static_cast<float>(1.0 / (node * node * node)),
             nodes_per_edge = static_cast<float>(bins.edge / node);
  for_each_bin(bins, first.array() - 2.0 * node, first.array() + (edge + 1) * node, [&](std::size_t b) {
    const Vec3f corner = ((bins.origin(b) - first) / node).cast<float>().array() + 2.0f;
    for (std::uint32_t j = bins.begin[b]; j < bins.begin[b + 1]; ++j) {
      int i[3];
      float w[3];
      bool reaches = true;
      for (int a = 0; a < 3; ++a) {
        const float x = corner[a] + nodes_per_edge * bins.offset[a][j];
        reaches = reaches && x >= 0.0f && x < static_cast<float>(spread - 1);
        i[a] = static_cast<int>(x);
        w[a] = x - static_cast<float>(i[a]);
      }
      if (!reaches) continue;
      float* at = &out[i[0] + spread * (i[1] + spread * i[2])];
      const float v = scale * volume[j];
      for (int n = 0; n < 4; ++n) {
        const float row = v * ((n & 1) != 0 ? w[1] : 1.0f - w[1]) * ((n & 2) != 0 ? w[2] : 1.0f - w[2]);
        float* line = at + spread * ((n & 1) + spread * (n >> 1));
        line[0] += row * (1.0f - w[0]);
        line[1] += row * w[0];
      }
    }
  });
}

/// [1 2 1]/4 along one axis, in place; the outermost entries along it are left.
void filter(Window& f, int stride) {
  // Along an axis the entries before `i` are already filtered: keep what they were.
  const int n = spread * spread * spread, run = stride * spread;
  for (int start = 0; start < n; start += run)
    for (int lane = 0; lane < stride; ++lane) {
      float before = f[start + lane];
      for (int i = 1; i + 1 < spread; ++i) {
        float& here = f[start + lane + i * stride];
        const float old = here;
        here = 0.25f * (before + f[start + lane + (i + 1) * stride]) + 0.5f * old;
        before = old;
      }
    }
}

std::array<std::uint64_t, 8> find_shallow(const ParticleBins& bins, std::span<const float> volume, const Vec3& first,
                                          double node) {
  Window f;
  spread_volumes(f, bins, volume, first, node);
  for (const int stride : {1, spread, spread * spread}) filter(f, stride);
  std::array<std::uint64_t, 8> shallow{};
  for (int k = 0; k < edge; ++k)
    for (int j = 0; j < edge; ++j)
      for (int i = 0; i < edge; ++i)
        if (f[i + 2 + spread * (j + 2 + spread * (k + 2))] < static_cast<float>(SurfaceRegion::deep_filling))
          shallow[k] |= std::uint64_t{1} << (i + 8 * j);
  return shallow;
}

}  // namespace

SurfaceRegion find_surface_region(const ParticleBins& bins, std::span<const float> volume, double node) {
  CHECK_EQ(volume.size(), bins.n_particles());
  SurfaceRegion region;
  region.node = node;
  region.key = find_blocks(bins, node);
  region.shallow.resize(region.key.size());
  parallel_blocks(
      region.key.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
          const Lattice p = lattice_from_key(region.key[b]);
          region.shallow[b] = find_shallow(bins, volume, node * edge * Vec3(p[0], p[1], p[2]), node);
        }
      },
      4);
  return region;
}

bool SurfaceRegion::touches_surface(const Box3& box) const {
  Lattice low, high;  // nodes
  for (int a = 0; a < 3; ++a) {
    low[a] = floor_to_int(box.lower[a] / node);
    high[a] = floor_to_int(box.upper[a] / node) + 1;
  }
  for (int z = low[2] >> 3; z <= high[2] >> 3; ++z)
    for (int y = low[1] >> 3; y <= high[1] >> 3; ++y)
      for (int x = low[0] >> 3; x <= high[0] >> 3; ++x) {
        const std::uint64_t wanted = lattice_key(x, y, z);
        const auto at = std::lower_bound(key.begin(), key.end(), wanted);
        if (at == key.end() || *at != wanted) return true;
        const auto& bits = shallow[static_cast<std::size_t>(at - key.begin())];
        // The part of the block that the box covers.
        const auto first = [&](int a, int block) { return std::max(low[a] - 8 * block, 0); };
        const auto last = [&](int a, int block) { return std::min(high[a] - 8 * block, 7); };
        const std::uint64_t row = ((std::uint64_t{2} << last(0, x)) - 1) & ~((std::uint64_t{1} << first(0, x)) - 1);
        std::uint64_t layer = 0;
        for (int j = first(1, y); j <= last(1, y); ++j) layer |= row << (8 * j);
        for (int k = first(2, z); k <= last(2, z); ++k)
          if ((bits[k] & layer) != 0) return true;
      }
  return false;
}

}  // namespace smelt
