#pragma once
// What the settings cost that users turn, and what they buy: one problem, one setting changed at a time.

#include "bench/cases/case.h"

namespace smelt::knobs {

/// The viscoplastic channel with other time steps, kernels, smoothing lengths, XSPH, artificial viscosity and lists.
Case make_flow_case();

/// The ball's surface on coarser and finer grids, with other kernels and without smoothing.
Case make_surface_case();

}  // namespace smelt::knobs
