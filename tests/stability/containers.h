#pragma once
// Spheres shaken in containers of triangles, of any number and for any number of steps: none may get out, none may be
// found inside a triangle. One program for a test of seconds (containers_test.cpp) and for the whole size
// (bench/containers_bench.cpp).

#include "core/geometry/simplex_bvh.h"
#include "core/sph/collision.h"

#include <functional>
#include <string>
#include <vector>

namespace smelt {

/// A vessel and how to tell what is in it. Openings are narrower than the spheres.
struct Container {
  std::string name;
  std::vector<Simplex<3>> facets;
  Box<3> bounds;                                   ///< of where spheres start [m]
  double radius = 0.0;                             ///< of the spheres [m]
  std::function<bool(const Vec3&)> contains = {};  ///< of a centre; within a hair of the facets either answer will do
};

Container make_closed_box();
/// A cone that ends in a hole of 0.9 diameters, under a lid.
Container make_funnel();
/// A box whose floor is strips of no thickness, woven at right angles, that leave square holes of 0.9 diameters:
/// T-junctions throughout.
Container make_sieve();
/// Half a ball of some 1500 triangles, under a lid.
Container make_bowl();
/// The inside of the Stanford dragon, mended: folds, spikes, concave corners.
Container make_dragon();

struct ShakeOptions {
  int n_particles = 1000;
  int n_steps = 100;
  int check_every = 10;  ///< [steps] all are looked at, and at the end
  std::uint64_t seed = 1;
};

struct Shaken {
  std::size_t n_particles = 0;
  std::size_t n_lost = 0;
  double deepest = 0.0;  ///< of any sphere in any facet, in radii
  double hits = 0.0;     ///< moves that met something, of all
  double way = 0.0;      ///< mean way of a step [radii]
  double seconds = 0.0;  ///< of moving alone, over all threads
};

/// Gravity, kicks of up to fifty radii a step in random directions, and five kinds of answer: no slip, slip, elastic,
/// half and half, almost elastic. The container's facets are obstacles, not walls: the whole radius counts.
Shaken shake(const Container& container, const ShakeOptions& options);

}  // namespace smelt
