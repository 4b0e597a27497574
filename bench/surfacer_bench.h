#pragma once
// How fast particles become a surface, against the bars of docs/decisions/0020-fast-surfaces.md.

namespace smelt {

/// Prints a table: particles a second and peak memory, from particles to an indexed, closed, smoothed mesh with
/// normals, for two shapes, 1 and (with `large`) 10 million particles, on as many threads as oneTBB is given. True
/// where every bar is met.
bool bench_surfacer(bool large);

}  // namespace smelt
