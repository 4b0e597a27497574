#pragma once
// The collapse of a water column a x 2a along a dry floor: its front against the experiments of Martin & Moyce (1952)
// and Koshizuka & Oka (1996).
//
// All sets have x/a over T = t sqrt(2g/a); that Koshizuka & Oka write L for a changes nothing. A column in a computer
// is let go at once, a diaphragm or a gate is not: each set has an origin of time of its own, fitted here (one number a
// set, stated), as is usual.

#include "bench/cases/case.h"
#include "bench/cases/norms.h"
#include "bench/cases/reference.h"
#include "core/sph/particles.h"

#include <array>

namespace smelt::dam_break {

inline constexpr std::array experiments{"koshizuka_oka", "martin_moyce_a1.125in",
                                        "martin_moyce_a2.25in"};  ///< references dam_break_*

struct Collapse {
  Reference front;         ///< column 0: T; column 1: x/a of the foremost particle's outer edge
  Particles<2> particles;  ///< at the end
};

/// Until T = 3.4, when Koshizuka & Oka's front meets the far wall; `n_across` particles across a = 0.146 m.
Collapse collapse(int n_across);

/// The front; before it is let go a column stands.
double front_at(const Reference& run, double t);

/// Relative differences of a run whose origin lies `origin` later than the experiment's.
Norms compare(const Reference& run, const Reference& experiment, double origin);

/// The origin, 0 to 0.6, with which the differences are least.
double fit_origin(const Reference& run, const Reference& experiment);

Case make_case();

}  // namespace smelt::dam_break
