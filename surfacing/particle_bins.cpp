#include "surfacing/particle_bins.h"

#include "core/error.h"
#include "core/parallel.h"

#include <tbb/parallel_sort.h>

namespace smelt {

namespace {

/// Key of the bin that holds a particle; the one place where positions are judged.
std::uint64_t bin_key(const Vec3& x, double edge, std::size_t particle) {
  if (!x.allFinite())
    fail(
        "surfacing: particle {} of the file, counted from 0, is at ({}, {}, {}): positions must be finite; the "
        "simulation diverged or the file is damaged",
        particle, x[0], x[1], x[2]);
  const Vec3 scaled = x / edge;
  if (scaled.cwiseAbs().maxCoeff() >= lattice_limit)
    fail(
        "surfacing: particle {} of the file, counted from 0, is at ({}, {}, {}) m: more than {:.3g} m from "
        "the origin cannot be gridded at this particle spacing; move the scene to the origin, or take the particle "
        "out of the file",
        particle, x[0], x[1], x[2], edge * lattice_limit);
  return lattice_key(floor_to_int(scaled[0]), floor_to_int(scaled[1]), floor_to_int(scaled[2]));
}

struct Entry {
  std::uint64_t key;
  std::uint32_t particle;
};

std::vector<Entry> sorted_entries(std::span<const Vec3> position, double edge) {
  std::vector<Entry> entries(position.size());
  parallel_for_each(entries.size(), [&](std::size_t i) {
    // Of several bad particles the first is named, whichever thread finds one: the others wait for the loop below.
    const Vec3 scaled = position[i] / edge;
    const bool good = scaled.cwiseAbs().maxCoeff() < lattice_limit && scaled.allFinite();
    entries[i] = {good ? bin_key(position[i], edge, i) : ~std::uint64_t{0}, static_cast<std::uint32_t>(i)};
  });
  tbb::parallel_sort(
      entries, [](const Entry& a, const Entry& b) { return a.key != b.key ? a.key < b.key : a.particle < b.particle; });
  const auto bad =
      std::find_if(entries.rbegin(), entries.rend(), [](const Entry& e) { return e.key != ~std::uint64_t{0}; });
  if (bad != entries.rbegin()) {
    const std::uint32_t first = bad.base()->particle;
    bin_key(position[first], edge, first);
  }
  return entries;
}

}  // namespace

Box3 ParticleBins::box(std::size_t bin) const {
  Vec3f low = Vec3f::Ones(), high = Vec3f::Zero();
  for (int a = 0; a < 3; ++a)
    for (std::uint32_t j = begin[bin]; j < begin[bin + 1]; ++j) {
      low[a] = std::min(low[a], offset[a][j]);
      high[a] = std::max(high[a], offset[a][j]);
    }
  const Vec3 corner = origin(bin);
  return {corner + edge * low.cast<double>(), corner + edge * high.cast<double>()};
}

ParticleBins sort_into_bins(std::span<const Vec3> position, double edge) {
  const std::size_t n = position.size();
  const std::vector<Entry> entries = sorted_entries(position, edge);
  ParticleBins bins;
  bins.edge = edge;
  for (std::size_t i = 0; i < n; ++i)
    if (i == 0 || entries[i].key != entries[i - 1].key) {
      bins.key.push_back(entries[i].key);
      bins.begin.push_back(static_cast<std::uint32_t>(i));
    }
  bins.begin.push_back(static_cast<std::uint32_t>(n));
  bins.index.resize(n);
  for (auto& o : bins.offset) o.resize(n + 8);
  parallel_for_each(n, [&](std::size_t i) {
    const std::uint32_t particle = entries[i].particle;
    const Lattice bin = lattice_from_key(entries[i].key);
    bins.index[i] = particle;
    for (int a = 0; a < 3; ++a) bins.offset[a][i] = static_cast<float>(position[particle][a] / edge - bin[a]);
  });
  return bins;
}

}  // namespace smelt
