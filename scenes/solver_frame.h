#pragma once
// A solver's particles as caches hold them.

#include "core/sph/particle_frame.h"
#include "core/sph/solver.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace smelt {

/// What the caches of a frame hold, ordered by id.
template <typename Real>
ParticleFrame to_frame(const Solver<3, Real>& solver, double spacing, int frame, double time) {
  const Particles<3>& p = solver.particles();
  ParticleFrame result;
  result.spacing = spacing;
  result.smoothing_length = solver.parameters().smoothing_length;
  result.mass = solver.mass(0);
  result.frame = frame;
  result.time = time;
  const std::size_t n = p.size();
  const auto& materials = solver.materials();
  const bool differ = std::any_of(materials.begin(), materials.end(),
                                  [&](const Material& m) { return m.density != materials.front().density; });
  std::vector<std::size_t> by_id(n);
  std::iota(by_id.begin(), by_id.end(), std::size_t{0});
  std::sort(by_id.begin(), by_id.end(), [&](std::size_t a, std::size_t b) { return p.id[a] < p.id[b]; });
  for (const std::size_t i : by_id) {
    result.id.push_back(p.id[i]);
    result.position.push_back(p.position[i]);
    result.velocity.push_back(p.velocity[i].cast<float>());
    result.density.push_back(static_cast<float>(p.density[i]));
    if (!p.temperature.empty()) result.temperature.push_back(static_cast<float>(p.temperature[i]));
    if (!p.viscosity.empty()) result.viscosity.push_back(p.viscosity[i]);
    if (differ) result.masses.push_back(static_cast<float>(solver.mass(i)));
  }
  return result;
}

}  // namespace smelt
