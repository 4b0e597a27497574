#pragma once
// The sites of a cubic lattice that lie inside a mesh.

#include "core/geometry/inside.h"

#include <cstdint>
#include <vector>

namespace smelt {

/// Sites first + spacing (i, j, k), 0 <= i < n_sites.x() and so on.
struct CubicLattice {
  Vec3 first;      ///< [m]
  double spacing;  ///< [m]
  Eigen::Array3i n_sites;
};

std::int64_t count_sites_inside(const InsideTest& inside, const CubicLattice& lattice);

/// Sites first <= i < last of a row along x.
struct SiteRun {
  int row;
  int first, last;
};

/// The sites inside a mesh; runs of a layer along z stand by ascending row, then site.
struct LatticeSites {
  CubicLattice lattice;
  std::vector<std::vector<SiteRun>> layers;

  /// From `x` to the nearest site [m]; `limit` [m] where none is nearer than that.
  double distance(const Vec3& x, double limit) const;

  /// Whether a site is nearer to `x` than `radius` [m].
  bool has_near(const Vec3& x, double radius) const;

 private:
  /// Calls visit(squared distance in spacings) for the nearest site of each run of the rows that come within `radius`
  /// [spacings] of `at` [spacings from the first site], until it returns true.
  template <typename Visit>
  void visit_near(const Vec3& at, double radius, const Visit& visit) const;
};

LatticeSites find_sites_inside(const InsideTest& inside, const CubicLattice& lattice);

}  // namespace smelt
