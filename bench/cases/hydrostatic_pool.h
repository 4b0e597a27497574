#pragma once
// Water at rest over a flat floor with its corners, in a tilted box and over a slope: p = rho g (level - y).

#include "bench/cases/case.h"
#include "core/sph/particles.h"
#include "core/sph/solver.h"

#include <string>
#include <vector>

namespace smelt::hydrostatic_pool {

constexpr double depth = 0.5, width = 1.0;  ///< [m]
constexpr double formed = 2.0;  ///< [s] from the start: particles have moved off the lattice to where they rest

/// A tank filled with particles at rest under the pressure of what is above them.
struct Pool {
  std::string name;
  int n_deep = 0;                 ///< particles
  std::vector<Vec<2>> wall = {};  ///< corners [m], as make_wall takes them
  Vec<2> up = Vec<2>(0.0, 1.0);
  double level = depth;  ///< along `up`
  Particles<2> particles = {};
  double settling = 0.0;  ///< [s] as a viscous fluid, whose pressure at rest is the same

  double spacing() const { return depth / n_deep; }  ///< [m]
};

/// Gravity is turned by `degrees` over a box.
Pool box_pool(const std::string& name, double degrees, int n_deep);

/// A flat floor that ends in a slope of 30 degrees. All sites in front of the slope are filled, so that the volume is
/// right, and those nearer than half a spacing are moved that far off; the level follows from the volume. A lattice
/// that starts farther off has gaps to sink into, and sloshes for longer than the test runs.
Pool slope_pool(int n_deep);

/// What a pool at rest should not show; shares of rho g depth, spacings, m/s.
struct Seen {
  double gauge = 0.0;           ///< largest error of pressure along the wetted wall, all times after `formed`
  double particle = 0.0;        ///< of a single particle
  double speed = 0.0;           ///< fastest particle at the end
  double drift = 0.0;           ///< root mean square way of the particles
  Particles<2> particles = {};  ///< at the end
};

/// Lets the pool rest for `duration` [s], longer than `formed`.
Seen rest(const Pool& pool, double duration);

Case make_case();

}  // namespace smelt::hydrostatic_pool
