#pragma once
// Viscous gravity currents along a flat floor: the plane and the axisymmetric one of [Huppert 1982] and, 2D, the
// viscous dam break of the lava benchmarks, all against lubrication theory.
//
// Where inertia is negligible nothing but g/nu counts. Both are divided by 100 here: the same flow, in steps that are
// ten times as long. What is left of inertia moves the front of the dam break by up to 1.6 %. The front is the foremost
// particle's outer edge.

#include "bench/cases/case.h"
#include "core/sph/collision.h"

namespace smelt::gravity_current {

/// How a current is computed.
struct Choices {
  double spacing;                 ///< [m]
  double sound_speed;             ///< [m/s], before inertia is made larger
  bool corrected = true;          ///< the divergence
  double shear_wave_speed = 0.0;  ///< [m/s], likewise; 0: stress at once
};

/// A wall with the fluid on the right hand of one who walks from `a` to `b` [m].
Obstacle<2> make_plane(const Vec<2>& a, const Vec<2>& b, double friction);

/// Constant volume, plane. The error is the largest of the front relative to the reference, the profile the front [m]
/// over time [s]. From the similarity profile h = h0 (1 - (x/x_N)^2)^(1/3) at 10 s, when it is an eighth as deep as
/// long, to the decade in which its depth over its length falls from 1/11 to 1/27.
Measurement run_plane_current(const Choices& choices);

/// The same in all directions from 10 s, when it is 0.16 times as deep as its radius, to 65 s.
Measurement run_axisymmetric_current(const Choices& choices);

/// Lava benchmark 1, from rest; fronts at the benchmark's times.
Measurement run_viscous_dam_break(const Choices& choices);

Case make_plane_case();
Case make_axisymmetric_case();
Case make_benchmark_case();

}  // namespace smelt::gravity_current
