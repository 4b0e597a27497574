#pragma once
// The slump of a Bingham cylinder under its own weight, 3D, against the formula of Pashias et al. (1996).

#include "bench/cases/case.h"
#include "core/sph/particles.h"

namespace smelt::slump {

struct Slumped {
  double slump = 0.0;      ///< (H - h)/H
  Particles<3> particles;  ///< at the end
};

/// A cylinder 0.3 m high as wide as tall, `n` particles high, whose yield stress is `relative_yield` rho g H, after
/// three seconds. The formula is a balance at rest, so the consistency is high enough for inertia not to carry the
/// column past it: 60 Pa s, with which the wide slump takes half a second.
Slumped simulate_slump(double relative_yield, int n);

Case make_case();

}  // namespace smelt::slump
