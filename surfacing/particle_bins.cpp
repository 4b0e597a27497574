#include "surfacing/particle_bins.h"

#include "core/error.h"

#include <tbb/parallel_sort.h>

namespace smelt {

namespace {

/// Key of the bin that holds a particle; the one place where positions are judged.
std::uint64_t bin_key(const Vec3& x, double edge, std::size_t particle) {
  if (!x.allFinite())
    fail(
        "surfacing: particle {} is at ({}, {}, {}): positions must be finite; the simulation diverged or the file is "
        "damaged",
        particle, x[0], x[1], x[2]);
  const Vec3 scaled = x / edge;
  if (scaled.cwiseAbs().maxCoeff() >= lattice_limit)
    fail(
        "surfacing: particle {} is at ({}, {}, {}) m: more than {:.3g} m from the origin cannot be gridded at this "
        "resolution; move the scene to the origin, drop the particle or take a coarser cell",
        particle, x[0], x[1], x[2], edge * lattice_limit);
  return lattice_key(floor_to_int(scaled[0]), floor_to_int(scaled[1]), floor_to_int(scaled[2]));
}

}  // namespace

ParticleBins sort_into_bins(std::span<const Vec3> position, double edge) {
  struct Entry {
    std::uint64_t key;
    std::uint32_t particle;
  };
  const std::size_t n = position.size();
  std::vector<Entry> entries(n);
  for (std::size_t i = 0; i < n; ++i) entries[i] = {bin_key(position[i], edge, i), static_cast<std::uint32_t>(i)};
  tbb::parallel_sort(
      entries, [](const Entry& a, const Entry& b) { return a.key != b.key ? a.key < b.key : a.particle < b.particle; });

  ParticleBins bins;
  bins.edge = edge;
  bins.index.resize(n);
  bins.position.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (i == 0 || entries[i].key != entries[i - 1].key) {
      bins.key.push_back(entries[i].key);
      bins.begin.push_back(static_cast<std::uint32_t>(i));
    }
    bins.index[i] = entries[i].particle;
    bins.position[i] = position[entries[i].particle];
  }
  bins.begin.push_back(static_cast<std::uint32_t>(n));
  return bins;
}

}  // namespace smelt
