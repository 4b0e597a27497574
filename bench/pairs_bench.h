#pragma once
// How near the pair loops come to what the machine can do: the roofline of docs/performance.md.

#include "bench/machine_peaks.h"

#include <string>
#include <vector>

namespace smelt {

/// One pass over all pairs of a melting scene, on one core.
struct PassTiming {
  std::string pass;          ///< "rates" or "forces"
  std::string instructions;  ///< "AVX2" or "AVX-512"
  std::size_t n_particles = 0;
  double pairs_per_second = 0.0;  ///< of the neighbour lists, the skin's pairs included, the padding not
  double flops_per_pair = 0.0;    ///< as counted in the loops, a square root or a division as one
  double bytes_per_pair = 0.0;    ///< of a record and the list's entry

  double flops() const { return pairs_per_second * flops_per_pair; }  ///< [1/s]
  double bytes() const { return pairs_per_second * bytes_per_pair; }  ///< [B/s]
};

struct PairsBench {
  MachinePeaks peaks;
  std::vector<PassTiming> passes;
};

/// Times both passes with all terms (stress, hourglass control, heat, XSPH) on a jittered block of about `n_particles`
/// with a mean skin, with every instruction set that this machine has.
PairsBench bench_pairs(std::size_t n_particles);

}  // namespace smelt
