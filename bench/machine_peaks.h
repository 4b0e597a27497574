#pragma once
// What one core of this machine can do at best, for the roofline in docs/performance.md.

namespace smelt {

/// Of one core, measured; bytes are read, with vector loads and additions, the second time over a buffer of the size
/// named.
struct MachinePeaks {
  double flops = 0.0;         ///< single precision, fused multiply-adds counting two [1/s]
  double l1_bytes = 0.0;      ///< 24 KiB [B/s]
  double l2_bytes = 0.0;      ///< 384 KiB [B/s]
  double l3_bytes = 0.0;      ///< 6 MiB [B/s]
  double memory_bytes = 0.0;  ///< 256 MiB [B/s]
};

/// Best of several runs, with the widest vectors that the pair loops use here; some two seconds.
MachinePeaks measure_machine_peaks();

}  // namespace smelt
