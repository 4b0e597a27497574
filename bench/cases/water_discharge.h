#pragma once
// Water discharge [S 4.5.3.2]: a column L x 2L of 1152 particles runs out of its vessel, against Torricelli.
//
// The text's figure of the vessel is lost: here the opening is L/3 high, eight of [S]'s particles, in the side at the
// floor (L/4, six of them, leaves four across the jet, two of which are its edges: 6.9 % off). Its lips are sharp,
// so that the jet is free on either side, and past its narrowing the pressure is nought: with h the level and V =
// -dh/dt,
//   v^2 = 2 g (h - y) + V^2  (Bernoulli from the surface to a particle at height y).
// [S] sums density [S 4.20], with a quintic kernel; here as in every scene of this project: continuity, cubic spline.

#include "bench/cases/case.h"
#include "core/sph/particles.h"

namespace smelt::water_discharge {

/// What the jet shows from one to two openings beyond the lips, from 0.2 to 0.3 s.
struct Jet {
  double speed = 0.0, torricelli = 0.0;  ///< means over its particles [m/s]
  double fastest = 0.0;                  ///< largest v / torricelli of a particle
  int n = 0;                             ///< particles seen, all times
  int leaked = 0;                        ///< particles found behind walls, all times
  Particles<2> particles = {};           ///< at the end
};

/// The first 0.3 s; `n_across` particles across L.
Jet discharge(int n_across);

Case make_case();

}  // namespace smelt::water_discharge
