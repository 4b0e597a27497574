#pragma once
// Steady plane channel flow of a viscoplastic fluid [P 6-1] between two walls, with the relaxed stress: profile and
// plug. Half width, density, yield stress and consistency are 1, the walls bear two yield stresses, the index is 1/2.

#include "bench/cases/case.h"
#include "bench/cases/reference.h"
#include "core/sph/solver.h"

namespace smelt::smd_channel {

constexpr double steady_time = 4.0;  ///< time from rest after which nothing changes

/// The steady profile for jump number 15, 150 or 1500: velocity and -du/dy over the distance from the middle.
Reference read_profile(int jump);

/// At rest: a channel -1 < y < 1 eight spacings long that repeats, `across` particles wide; `tune` may change its
/// settings.
Solver<2, double> make_channel(int across, double jump, const std::function<void(SolverParameters<2>&)>& tune = {});

struct Errors {
  double velocity;  ///< L2 of the differences over L2 of the velocity
  double plug;      ///< half width of what is below the yield stress
};
Errors measure(const Particles<2>& particles, const Reference& reference, int across);

Case make_case();

}  // namespace smelt::smd_channel
