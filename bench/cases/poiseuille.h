#pragma once
// Start-up of plane Poiseuille flow between two walls [Morris 1997]: width 1 mm, viscosity and density of water, body
// force 1e-4 m/s^2.

#include "bench/cases/case.h"
#include "core/sph/kernel.h"

#include <array>

namespace smelt::poiseuille {

inline constexpr std::array times{0.0225, 0.045, 0.1125, 0.225, 1.0};  ///< [s], one a column of the reference

struct Setting {
  double jitter = 0.0;  ///< of the lattice at the start, in spacings
  double hourglass_control = 1.0;
  bool wall = true;
  KernelType kernel = KernelType::cubic_spline;
};

/// sqrt(sum e^2 / sum u^2) over the particles at each of the times, e what a velocity along the channel is off;
/// `across` particles from plane to plane.
std::array<double, times.size()> run_channel(int across, const Setting& setting);

Case make_case();

}  // namespace smelt::poiseuille
