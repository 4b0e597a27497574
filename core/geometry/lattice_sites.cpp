#include "core/geometry/lattice_sites.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace smelt {
namespace {

/// Calls visit(first, last) for each run of sites first <= i < last of row (j, k) that lies inside, by ascending i.
/// `crossings` is scratch space.
template <typename Visit>
void visit_row(const InsideTest& inside, const CubicLattice& lattice, int j, int k, std::vector<Crossing>& crossings,
               Visit visit) {
  inside.intersect(lattice.first.y() + j * lattice.spacing, lattice.first.z() + k * lattice.spacing, crossings);
  int winding = 0;
  for (std::size_t c = 0; c + 1 < crossings.size(); ++c) {
    winding += crossings[c].winding;
    if (winding == 0) continue;
    const auto site_after = [&](double x) {
      return std::clamp(static_cast<int>(std::ceil((x - lattice.first.x()) / lattice.spacing)), 0, lattice.n_sites.x());
    };
    visit(site_after(crossings[c].x), site_after(crossings[c + 1].x));
  }
}

}  // namespace

std::int64_t count_sites_inside(const InsideTest& inside, const CubicLattice& lattice) {
  std::vector<std::int64_t> of_layer(static_cast<std::size_t>(lattice.n_sites.z()), 0);
  tbb::parallel_for(0, lattice.n_sites.z(), [&](int k) {
    std::vector<Crossing> crossings;
    for (int j = 0; j < lattice.n_sites.y(); ++j)
      visit_row(inside, lattice, j, k, crossings,
                [&](int first, int last) { of_layer[static_cast<std::size_t>(k)] += last - first; });
  });
  return std::accumulate(of_layer.begin(), of_layer.end(), std::int64_t{0});
}

LatticeSites find_sites_inside(const InsideTest& inside, const CubicLattice& lattice) {
  LatticeSites sites{lattice, std::vector<std::vector<SiteRun>>(static_cast<std::size_t>(lattice.n_sites.z()))};
  tbb::parallel_for(0, lattice.n_sites.z(), [&](int k) {
    std::vector<Crossing> crossings;
    for (int j = 0; j < lattice.n_sites.y(); ++j)
      visit_row(inside, lattice, j, k, crossings, [&](int first, int last) {
        if (first < last) sites.layers[static_cast<std::size_t>(k)].push_back({j, first, last});
      });
  });
  return sites;
}

template <typename Visit>
void LatticeSites::visit_near(const Vec3& at, double radius, const Visit& visit) const {
  const int first_layer = std::max(0, static_cast<int>(std::ceil(at.z() - radius)));
  const int last_layer = std::min(lattice.n_sites.z() - 1, static_cast<int>(std::floor(at.z() + radius)));
  for (int k = first_layer; k <= last_layer; ++k) {
    const std::vector<SiteRun>& runs = layers[static_cast<std::size_t>(k)];
    const auto is_before = [](const SiteRun& run, double row) { return run.row < row; };
    for (auto run = std::lower_bound(runs.begin(), runs.end(), at.y() - radius, is_before);
         run != runs.end() && run->row <= at.y() + radius; ++run) {
      const double i =
          std::clamp(std::round(at.x()), static_cast<double>(run->first), static_cast<double>(run->last - 1));
      if (visit((at - Vec3(i, run->row, k)).squaredNorm())) return;
    }
  }
}

double LatticeSites::distance(const Vec3& x, double limit) const {
  double nearest = std::numeric_limits<double>::infinity();
  visit_near((x - lattice.first) / lattice.spacing, limit / lattice.spacing, [&](double squared) {
    nearest = std::min(nearest, squared);
    return false;
  });
  return std::min(limit, std::sqrt(nearest) * lattice.spacing);
}

bool LatticeSites::has_near(const Vec3& x, double radius) const {
  bool found = false;
  const double squared_radius = radius * radius / (lattice.spacing * lattice.spacing);
  visit_near((x - lattice.first) / lattice.spacing, radius / lattice.spacing,
             [&](double squared) { return found = squared < squared_radius; });
  return found;
}

}  // namespace smelt
