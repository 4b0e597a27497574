#pragma once
// A scalar field on a regular grid of samples that is stored only near the surface, in blocks of 8 x 8 x 8.

#include "surfacing/kernel_shapes.h"
#include "surfacing/particle_bins.h"
#include "surfacing/surface_region.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace smelt {

/// Sample (i, j, k) sits at cell * (i, j, k) [m]: the grid is anchored at the origin of the world, not at the
/// particles, so that it stands still from frame to frame. Block (I, J, K) holds the samples 8 I .. 8 I + 7 and so on.
/// Samples of absent blocks are 1 in the blocks of `deep`, 0 in others.
struct SparseField {
  static constexpr int block_edge = 8;
  static constexpr int block_size = block_edge * block_edge * block_edge;
  static constexpr int edges_per_block = 3 * block_size;  ///< from each sample to the next one up along each axis
  static constexpr std::size_t no_block = static_cast<std::size_t>(-1);

  double cell = 0.0;               ///< distance between samples [m]
  std::vector<std::uint64_t> key;  ///< lattice_key of each stored block, ascending
  std::vector<float> value;        ///< block_size per block, x fastest
  std::vector<std::uint64_t>
      deep;  ///< lattice_key of the absent neighbours of stored blocks that lie inside, ascending

  std::size_t n_blocks() const { return key.size(); }
  /// Position of a block in `key`, or no_block.
  std::size_t find(std::uint64_t block_key) const;
  /// What every sample of an absent block is.
  float absent_value(std::uint64_t block_key) const;
  /// Value at a sample; slow (a search), for tests and single look-ups.
  float sample(int i, int j, int k) const;
};

/// What chi is a sum of: V_j and the smoothing length h [m], and where they are given the shapes of the kernels.
struct ChiSource {
  const ParticleBins& bins;
  std::span<const float> volume;  ///< [m^3], in the order of `bins`
  double h = 0.0;
  const KernelShapes* shapes = nullptr;
};

/// The blocks that hold every sample within `radius` [m] of a particle and every sample one step below those, which is
/// what `extract_iso_surface` asks for; without values. With a `region`, only those of them that touch the surface.
/// Throws Error when the field, and a mesh made of it, would need more than `memory_limit` bytes.
SparseField allocate_field(const ParticleBins& bins, double radius, double cell, double memory_limit,
                           const SurfaceRegion* region = nullptr);

/// chi(x) = sum_j V_j W(x - x_j, h)  [P 5-7], cubic spline, at every sample of the blocks that `allocate_field` names.
/// With a `region`, deep blocks are left out, except where chi is below `iso` on the side of a stored block: those are
/// taken in, until the surface closes. Each block gathers from its particles in their sorted order, so the sums do not
/// depend on threads. Single precision, relative to the block: absolute error about 1e-6.
SparseField compute_chi(const ChiSource& source, double cell, float iso, double memory_limit,
                        const SurfaceRegion* region = nullptr);

}  // namespace smelt
