#include "core/geometry/seeding.h"

#include "core/error.h"
#include "core/geometry/inside.h"
#include "core/geometry/lattice_sites.h"
#include "core/geometry/thin_parts.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace smelt {
namespace {

/// How a lattice sits in the bounds: from the lower corner, or about the centre with a site (0) or the middle between
/// two sites (1/2) on it.
struct Alignment {
  bool centred = false;
  Vec3 offset = Vec3::Constant(0.5);
};

constexpr int max_sites_per_axis = 20000;

CubicLattice make_lattice(const Box3& bounds, double spacing, const Alignment& alignment) {
  CubicLattice lattice{Vec3::Zero(), spacing, Eigen::Array3i::Zero()};
  for (int k = 0; k < 3; ++k) {
    double first = bounds.lower[k] + alignment.offset[k] * spacing;
    if (alignment.centred) {
      const double half_width = 0.5 * bounds.extent()[k] / spacing - alignment.offset[k];
      first = bounds.centre()[k] - (std::max(0.0, std::floor(half_width)) + alignment.offset[k]) * spacing;
    }
    const double n = std::max(0.0, std::floor((bounds.upper[k] - first) / spacing) + 1.0);
    if (n > max_sites_per_axis)
      fail(
          "a lattice of {:.4g} m has {:.0f} sites along one axis of the mesh, at most {} are allowed: ask for fewer "
          "particles or a "
          "wider spacing (are the units metres?)",
          spacing, n, max_sites_per_axis);
    lattice.first[k] = first;
    lattice.n_sites[k] = static_cast<int>(n);
  }
  return lattice;
}

/// A lattice and how many of its sites are inside.
struct Fit {
  CubicLattice lattice;
  std::int64_t n_sites = 0;
};

/// By how much the cells of the sites inside miss the body's volume, as a fraction of it.
double volume_error(const Fit& fit, double volume) {
  return std::abs(static_cast<double>(fit.n_sites) * std::pow(fit.lattice.spacing, 3) / volume - 1.0);
}

bool is_within(std::int64_t n, std::int64_t wanted, double allowed) {
  return static_cast<double>(std::abs(n - wanted)) <= allowed * static_cast<double>(wanted);
}

/// The nearest to `wanted` sites wins, but only after those that fill the body.
bool is_better(const Fit& a, const Fit& b, std::int64_t wanted, double volume) {
  constexpr double allowed = 0.1;
  const bool a_fills = volume_error(a, volume) <= allowed, b_fills = volume_error(b, volume) <= allowed;
  if (a_fills != b_fills) return a_fills;
  return std::abs(a.n_sites - wanted) < std::abs(b.n_sites - wanted);
}

/// Searches the spacing of lattices with one alignment. The count falls with the spacing, but not monotonically: sites
/// enter as others leave, so a bisection is followed by a scan about its result.
void search_spacing(const InsideTest& inside, double volume, std::int64_t wanted, const Alignment& alignment,
                    std::optional<Fit>& best) {
  const auto try_spacing = [&](double spacing) {
    Fit fit{make_lattice(inside.bounds(), spacing, alignment), 0};
    fit.n_sites = count_sites_inside(inside, fit.lattice);
    if (!best || is_better(fit, *best, wanted, volume)) best = fit;
    return fit.n_sites;
  };
  const double start = std::cbrt(volume / static_cast<double>(wanted));
  double fine = 0.95 * start, coarse = 1.05 * start;
  for (int step = 0; step < 40 && coarse - fine > 1e-9 * start; ++step) {
    const double middle = 0.5 * (fine + coarse);
    const std::int64_t n = try_spacing(middle);
    if (n == wanted) return;
    (n > wanted ? fine : coarse) = middle;
  }
  constexpr int n_scan = 16;
  const double nearest = 0.5 * (fine + coarse);
  for (int k = -n_scan; k <= n_scan; ++k)
    if (try_spacing(nearest * (1.0 + 1e-4 * k)) == wanted) return;
}

/// Lattices centred on the bounds are tried where the first one misses the number by more than 1 %.
Fit fit_count(const InsideTest& inside, double volume, std::int64_t wanted) {
  std::optional<Fit> best;
  search_spacing(inside, volume, wanted, {}, best);
  for (int parity = 0; parity < 8 && !is_within(best->n_sites, wanted, 0.01); ++parity) {
    const Vec3 offset(parity & 1 ? 0.0 : 0.5, parity & 2 ? 0.0 : 0.5, parity & 4 ? 0.0 : 0.5);
    search_spacing(inside, volume, wanted, {true, offset}, best);
  }
  return *best;
}

/// The sites of a lattice, and the places that it leaves free in thin parts.
struct Filling {
  Fit fit;
  LatticeSites sites;
  std::vector<Vec3> in_thin_parts;

  std::int64_t count() const { return fit.n_sites + static_cast<std::int64_t>(in_thin_parts.size()); }
};

Filling fill(const TriangleMesh& mesh, const InsideTest& inside, const Fit& fit) {
  Filling filling{fit, find_sites_inside(inside, fit.lattice), {}};
  filling.in_thin_parts = fill_thin_parts(mesh, inside, filling.sites);
  return filling;
}

/// What thin parts take is left out of the lattice, which changes them a little in turn: a few rounds settle it.
Filling fill_to_count(const TriangleMesh& mesh, const InsideTest& inside, double volume, std::int64_t wanted) {
  constexpr int most_rounds = 4;
  std::int64_t of_lattice = wanted;
  Filling filling = fill(mesh, inside, fit_count(inside, volume, of_lattice)), best = filling;
  const auto misses_by_thin_parts = [&] {
    return std::abs(filling.count() - wanted) > std::abs(filling.fit.n_sites - of_lattice);
  };
  for (int round = 0; round < most_rounds && misses_by_thin_parts(); ++round) {
    of_lattice = wanted - static_cast<std::int64_t>(filling.in_thin_parts.size());
    if (of_lattice <= 0) break;
    filling = fill(mesh, inside, fit_count(inside, volume, of_lattice));
    if (std::abs(filling.count() - wanted) < std::abs(best.count() - wanted)) best = filling;
  }
  if (!is_within(best.count(), wanted, 0.1))
    fail(
        "no cubic lattice puts {} particles into this mesh (10 % off is allowed); the nearest holds {}: ask for as "
        "many",
        wanted, best.count());
  return best;
}

/// splitmix64's finaliser: all bits of the result depend on all bits of `x`.
std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Uniform in [-1, 1) along each axis, a function of seed and site alone.
Vec3 random_shift(std::uint64_t seed, int i, int j, int k) {
  std::uint64_t h = mix(seed + 0x9e3779b97f4a7c15ULL);
  for (const int index : {i, j, k}) h = mix(h + static_cast<std::uint64_t>(index) + 0x9e3779b97f4a7c15ULL);
  Vec3 shift;
  for (int axis = 0; axis < 3; ++axis) {
    h = mix(h + 0x9e3779b97f4a7c15ULL);
    shift[axis] = static_cast<double>(h >> 11) * 0x1p-52 - 1.0;
  }
  return shift;
}

std::vector<Vec3> place_sites(const InsideTest& inside, const LatticeSites& sites, const SeedingOptions& options) {
  const CubicLattice& lattice = sites.lattice;
  std::vector<std::vector<Vec3>> of_layer(sites.layers.size());
  tbb::parallel_for(0, lattice.n_sites.z(), [&](int k) {
    std::vector<Crossing> crossings;
    std::vector<Vec3>& layer = of_layer[static_cast<std::size_t>(k)];
    for (const SiteRun& run : sites.layers[static_cast<std::size_t>(k)])
      for (int i = run.first; i < run.last; ++i) {
        const Vec3 site = lattice.first + lattice.spacing * Vec3(i, run.row, k);
        const Vec3 shifted = site + options.jitter * lattice.spacing * random_shift(options.seed, i, run.row, k);
        const bool stays = options.jitter > 0.0 && inside.contains(shifted, crossings);
        layer.push_back(stays ? shifted : site);
      }
  });
  std::vector<Vec3> positions;
  for (const std::vector<Vec3>& layer : of_layer) positions.insert(positions.end(), layer.begin(), layer.end());
  return positions;
}

/// A lattice that misses more than a fifth of the body, or adds it, would give particles of the wrong size.
void check_thickness(const InsideTest& inside, double volume, const Fit& fit) {
  constexpr double allowed = 0.2;
  if (volume_error(fit, volume) <= allowed) return;
  Fit finer = fit;
  while (volume_error(finer, volume) > 0.5 * allowed) {
    finer.lattice = make_lattice(inside.bounds(), 0.8 * finer.lattice.spacing, {});
    finer.n_sites = count_sites_inside(inside, finer.lattice);
  }
  fail(
      "the mesh is too thin for particles {:.4g} m apart: {} of them fit, {:.0f} % off its volume of {:.4g} m^3 (20 % "
      "is allowed); a spacing "
      "of {:.3g} m ({} particles) would do",
      fit.lattice.spacing, fit.n_sites, 100.0 * volume_error(fit, volume), volume, finer.lattice.spacing,
      finer.n_sites);
}

void check_options(const SeedingOptions& options) {
  if ((options.count > 0) == (options.spacing > 0.0) || options.count < 0 || !(options.spacing >= 0.0) ||
      !std::isfinite(options.spacing))
    fail("particles: count = {} and spacing = {} m; give one of them, greater than zero", options.count,
         options.spacing);
  if (options.count > std::numeric_limits<std::int32_t>::max())
    fail("particles: count = {}; at most {} are allowed", options.count, std::numeric_limits<std::int32_t>::max());
  if (!(options.jitter >= 0.0 && options.jitter < 0.5))
    fail("particles: jitter = {}; allowed is a fraction of the spacing from 0 to below 0.5", options.jitter);
}

double volume_of_closed(const TriangleMesh& mesh) {
  const double volume = compute_volume(mesh);
  if (const MeshTopology topology = compute_topology(mesh); !topology.closed())
    fail(
        "the mesh to fill with particles is not closed: {} boundary, {} non-manifold and {} misoriented edges; repair "
        "it first",
        topology.n_boundary_edges, topology.n_nonmanifold_edges, topology.n_misoriented_edges);
  if (!(volume > 0.0))
    fail(
        "the mesh to fill with particles has a volume of {:.4g} m^3; it must be wound outward and not be flat; repair "
        "it first",
        volume);
  return volume;
}

}  // namespace

Seeds seed_particles(const TriangleMesh& mesh, const SeedingOptions& options) {
  check_options(options);
  const double volume = volume_of_closed(mesh);
  const double width = options.count > 0 ? std::cbrt(volume / static_cast<double>(options.count)) : options.spacing;
  const InsideTest inside(mesh, width);

  Filling filling;
  if (options.count > 0) {
    filling = fill_to_count(mesh, inside, volume, options.count);
  } else {
    const CubicLattice lattice = make_lattice(inside.bounds(), options.spacing, {});
    filling = fill(mesh, inside, {lattice, count_sites_inside(inside, lattice)});
  }
  check_thickness(inside, volume, filling.fit);

  Seeds seeds;
  seeds.positions = place_sites(inside, filling.sites, options);
  seeds.positions.insert(seeds.positions.end(), filling.in_thin_parts.begin(), filling.in_thin_parts.end());
  seeds.n_in_thin_parts = filling.in_thin_parts.size();
  seeds.lattice_spacing = filling.fit.lattice.spacing;
  seeds.spacing = std::cbrt(volume / static_cast<double>(seeds.positions.size()));
  seeds.volume = volume;
  return seeds;
}

}  // namespace smelt
