#include "surfacing/attributes.h"

#include "core/error.h"
#include "core/parallel.h"
#include "surfacing/local_particles.h"

#include <tbb/parallel_sort.h>

namespace smelt {

namespace {

constexpr std::size_t n_fields = 6;            // velocity, temperature, viscosity, extra
constexpr std::size_t n_fields_with_rest = 9;  // and the rest position

struct VertexInBin {
  std::uint64_t key;
  std::uint32_t vertex;
};

/// Vertices sorted by the bin they are in, so that those of a bin share their neighbours.
std::vector<VertexInBin> sort_vertices(const std::vector<Vec3>& vertices, double edge) {
  std::vector<VertexInBin> out(vertices.size());
  parallel_for_each(vertices.size(), [&](std::size_t v) {
    const Vec3 b = vertices[v] / edge;
    out[v] = {lattice_key(floor_to_int(b[0]), floor_to_int(b[1]), floor_to_int(b[2])), static_cast<std::uint32_t>(v)};
  });
  tbb::parallel_sort(out, [](const VertexInBin& a, const VertexInBin& b) {
    return a.key != b.key ? a.key < b.key : a.vertex < b.vertex;
  });
  return out;
}

template <std::size_t N>
std::vector<float> average_at_vertices(SurfaceMesh& surface, const ParticleFrame& particles, const ParticleBins& bins,
                                       std::span<const float> volume, std::span<const float> extra, double h) {
  constexpr bool has_rest = N == n_fields_with_rest;
  const bool has_temperature = !particles.temperature.empty(), has_viscosity = !particles.viscosity.empty();
  const std::vector<Vec3>& vertices = surface.mesh.vertices;
  const std::size_t n = vertices.size();
  surface.velocity.resize(n);
  surface.temperature.resize(has_temperature ? n : 0);
  surface.viscosity.resize(has_viscosity ? n : 0);
  surface.rest.resize(has_rest ? n : 0);
  std::vector<float> extra_at_vertex(n);
  const auto fields_of = [&](std::uint32_t j) {
    const std::uint32_t i = bins.index[j];
    const Vec3f& v = particles.velocity[i];
    std::array<float, N> fields{v[0],
                                v[1],
                                v[2],
                                has_temperature ? particles.temperature[i] : 0.0f,
                                has_viscosity ? particles.viscosity[i] : 0.0f,
                                extra[j]};
    if constexpr (has_rest)
      for (std::size_t a = 0; a < 3; ++a) fields[n_fields + a] = particles.rest[i][static_cast<int>(a)];
    return fields;
  };

  const std::vector<VertexInBin> sorted = sort_vertices(vertices, bins.edge);
  std::vector<std::size_t> group;
  for (std::size_t i = 0; i < n; ++i)
    if (i == 0 || sorted[i].key != sorted[i - 1].key) group.push_back(i);
  group.push_back(n);
  const auto take_average = [&](LocalParticles<N>& near, LocalParticles<N>& wider, std::uint32_t v) {
    auto total = sum_at(near, vertices[v]);
    for (double h_wider = 2.0 * h; !(total[0] > 0.0f); h_wider *= 2.0) {
      gather_particles(wider, bins, volume, Box3(vertices[v], vertices[v]), h_wider, fields_of);
      total = sum_at(wider, vertices[v]);
    }
    surface.velocity[v] = Vec3f(total[1], total[2], total[3]) / total[0];
    if (has_temperature) surface.temperature[v] = total[4] / total[0];
    if (has_viscosity) surface.viscosity[v] = total[5] / total[0];
    extra_at_vertex[v] = total[6] / total[0];
    if constexpr (has_rest) surface.rest[v] = Vec3f(total[7], total[8], total[9]) / total[0];
  };
  parallel_blocks(
      group.size() - 1,
      [&](std::size_t begin, std::size_t end) {
        LocalParticles<N> near, wider;
        for (std::size_t g = begin; g < end; ++g) {
          Box3 box;
          for (std::size_t i = group[g]; i < group[g + 1]; ++i) box.extend(vertices[sorted[i].vertex]);
          gather_particles(near, bins, volume, box, h, fields_of);
          for (std::size_t i = group[g]; i < group[g + 1]; ++i) take_average(near, wider, sorted[i].vertex);
        }
      },
      16);
  return extra_at_vertex;
}

}  // namespace

std::vector<float> compute_attributes(SurfaceMesh& surface, const ParticleFrame& particles, const ParticleBins& bins,
                                      std::span<const float> volume, std::span<const float> extra, double h) {
  CHECK_GT(bins.n_particles(), std::size_t{0});
  CHECK_EQ(volume.size(), bins.n_particles());
  CHECK_EQ(extra.size(), bins.n_particles());
  if (particles.rest.empty()) return average_at_vertices<n_fields>(surface, particles, bins, volume, extra, h);
  return average_at_vertices<n_fields_with_rest>(surface, particles, bins, volume, extra, h);
}

}  // namespace smelt
