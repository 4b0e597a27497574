// Seeding by exact predicates against seeding by the sign of OpenVDB's field: the tables of docs/decisions/0007. The
// agreement itself is tested in tests/core/geometry/inside_oracle_test.cpp.

#include "bench/peak_memory.h"
#include "core/geometry/inside.h"
#include "core/geometry/seeding.h"
#include "core/parallel.h"
#include "tests/core/geometry/sampled_field.h"
#include "tests/meshes.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <chrono>
#include <cstdio>

namespace smelt {
namespace {

struct Cost {
  double seconds = std::numeric_limits<double>::infinity();  ///< best of three
  double megabytes = 0.0;                                    ///< resident at the peak, above that before
};

template <typename Act>
Cost measure(Act act) {
  Cost cost;
  for (int run = 0; run < 3; ++run) {
    reset_peak_memory();
    const double before = peak_memory();
    const auto start = std::chrono::steady_clock::now();
    act();
    cost.seconds =
        std::min(cost.seconds, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    cost.megabytes = std::max(cost.megabytes, peak_memory() - before);
  }
  return cost;
}

/// Sites of seed_particles' lattice (half a spacing from the lower corner) where the field is negative, layer after
/// layer.
std::vector<Vec3> sites_inside(const openvdb::FloatGrid& field, const Box3& box, double spacing) {
  const Vec3 first = box.lower + Vec3::Constant(0.5 * spacing);
  const Eigen::Array3i n = ((box.upper - first) / spacing).array().floor().cast<int>() + 1;
  std::vector<std::vector<Vec3>> layers(static_cast<std::size_t>(n.z()));
  parallel_blocks(
      layers.size(),
      [&](std::size_t begin, std::size_t end) {
        const FieldSign sign(field);
        for (std::size_t k = begin; k < end; ++k)
          for (int j = 0; j < n.y(); ++j)
            for (int i = 0; i < n.x(); ++i) {
              const Vec3 site = first + spacing * Vec3(i, j, static_cast<double>(k));
              if (sign.contains(site)) layers[k].push_back(site);
            }
      },
      1);
  std::vector<Vec3> sites;
  for (const std::vector<Vec3>& layer : layers) sites.insert(sites.end(), layer.begin(), layer.end());
  return sites;
}

/// What seed_particles does, the field deciding: bisect the spacing, then scan about it.
struct FieldSeeds {
  std::vector<Vec3> positions;
  double lattice_spacing = 0.0;
};

FieldSeeds seed_from_field(const TriangleMesh& mesh, std::int64_t wanted, double voxel_size) {
  const openvdb::FloatGrid::Ptr field = make_field(mesh, voxel_size, Vec3::Zero());
  const Box3 box = compute_bounds(mesh);
  FieldSeeds best;
  const auto miss = [&](const std::vector<Vec3>& sites) {
    return std::abs(static_cast<std::int64_t>(sites.size()) - wanted);
  };
  const auto try_spacing = [&](double spacing) {
    std::vector<Vec3> sites = sites_inside(*field, box, spacing);
    const auto n = static_cast<std::int64_t>(sites.size());
    if (best.positions.empty() || miss(sites) < miss(best.positions)) best = {std::move(sites), spacing};
    return n;
  };
  const double start = std::cbrt(compute_volume(mesh) / static_cast<double>(wanted));
  double fine = 0.95 * start, coarse = 1.05 * start;
  for (int step = 0; step < 40 && coarse - fine > 1e-9 * start; ++step) {
    const double middle = 0.5 * (fine + coarse);
    const std::int64_t n = try_spacing(middle);
    if (n == wanted) return best;
    (n > wanted ? fine : coarse) = middle;
  }
  const double nearest = 0.5 * (fine + coarse);
  for (int k = -16; k <= 16; ++k)
    if (try_spacing(nearest * (1.0 + 1e-4 * k)) == wanted) break;
  return best;
}

/// Sites about the mesh on which the field contradicts InsideTest, and how far the furthest is from the surface
/// [voxels].
struct Contradictions {
  int n = 0;
  double furthest = 0.0;
};

Contradictions find_contradictions(const TriangleMesh& mesh, const openvdb::FloatGrid& field, double spacing) {
  const InsideTest inside(mesh, spacing);
  const FieldSign sign(field);
  const Box3& box = inside.bounds();
  Contradictions found;
  std::vector<Crossing> crossings;
  const Vec3 first = box.lower + Vec3::Constant(0.5 * spacing);
  const Eigen::Array3i n = ((box.upper - first) / spacing).array().floor().cast<int>() + 1;
  for (int k = 0; k < n.z(); ++k)
    for (int j = 0; j < n.y(); ++j)
      for (int i = 0; i < n.x(); ++i) {
        const Vec3 site = first + spacing * Vec3(i, j, k);
        if (inside.contains(site, crossings) == sign.contains(site)) continue;
        ++found.n;
        found.furthest = std::max(found.furthest, distance_to_surface(mesh, site) / field.voxelSize()[0]);
      }
  return found;
}

/// Voxels whose values differ between one thread and two, the most of five tries.
int count_thread_differences(const TriangleMesh& mesh, double voxel_size) {
  const auto make = [&](std::size_t n_threads) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, n_threads);
    return make_field(mesh, voxel_size, Vec3::Zero());
  };
  const openvdb::FloatGrid::Ptr one = make(1);
  int most = 0;
  for (int run = 0; run < 5; ++run) {
    const openvdb::FloatGrid::Ptr two = make(2);
    int n = std::abs(static_cast<int>(one->activeVoxelCount()) - static_cast<int>(two->activeVoxelCount()));
    for (auto voxel = one->cbeginValueOn(); voxel; ++voxel) n += two->tree().getValue(voxel.getCoord()) != *voxel;
    most = std::max(most, n);
  }
  return most;
}

void compare(const std::string& name, const TriangleMesh& mesh, std::int64_t wanted) {
  const double volume = compute_volume(mesh);
  const auto print = [&](const std::string& way, std::size_t n, double spacing, const Cost& cost,
                         const std::string& rest) {
    fmt::print("| {} | {} | {:+.3f} % | {:+.3f} % | {:.3f} | {:.1f} | {} |\n", name, way,
               100.0 * (static_cast<double>(n) / static_cast<double>(wanted) - 1.0),
               100.0 * (static_cast<double>(n) * spacing * spacing * spacing / volume - 1.0), cost.seconds,
               cost.megabytes, rest);
  };
  SeedingOptions options;
  options.count = wanted;
  Seeds seeds;
  const Cost exact_cost = measure([&] { seeds = seed_particles(mesh, options); });
  print("exact", seeds.positions.size(), seeds.lattice_spacing, exact_cost, "| 0 | | 0 | 0");
  const double spacing = seeds.lattice_spacing;
  for (const double fraction : {1.0, 0.5, 0.25}) {
    const double voxel_size = fraction * spacing;
    FieldSeeds from_field;
    const Cost cost = measure([&] { from_field = seed_from_field(mesh, wanted, voxel_size); });
    const Cost cost_of_field = measure([&] { make_field(mesh, voxel_size, Vec3::Zero()); });
    const Contradictions plain = find_contradictions(mesh, *make_field(mesh, voxel_size, Vec3::Zero()), spacing);
    const Vec3 first_site = compute_bounds(mesh).lower + Vec3::Constant(0.5 * spacing);
    const Contradictions on_sites = find_contradictions(mesh, *make_field(mesh, voxel_size, first_site), spacing);
    print(fmt::format("field, {} spacing", fraction), from_field.positions.size(), from_field.lattice_spacing, cost,
          fmt::format("{:.3f} | {} | {:.2f} | {} | {}", cost_of_field.seconds, plain.n, plain.furthest, on_sites.n,
                      count_thread_differences(mesh, voxel_size)));
  }
}

}  // namespace
}  // namespace smelt

int main() {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  using namespace smelt;
  fmt::print(
      "| mesh | way | count | n cell/V - 1 | s | MiB | s, field alone | sites that differ | furthest from the surface, "
      "voxels | sites that differ, voxels on the sites | voxels that differ on 2 threads |\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|---|---|\n");
  compare("bunny", load_asset("bunny.obj"), 10188);
  compare("plate", make_tilted_plate(), 10188);
  compare("spikes", make_spiky_ball(), 10188);
  const TriangleMesh ball = make_sphere(Vec3::Zero(), 1.0, 4);
  compare("hollow ball", joined(ball, turned_inside_out(make_sphere(Vec3::Zero(), 0.5, 4))), 10188);
  compare("small cavity", joined(ball, turned_inside_out(make_sphere(Vec3(0.01, 0.3, 0.1), 0.15, 3))), 10188);
  compare("bunny, 10^6", load_asset("bunny.obj"), 1000000);
}
