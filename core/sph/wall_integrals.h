#pragma once
// Integrals of a smoothing kernel over a solid bounded by facets: triangles in 3D, segments in 2D, points in 1D.
//
// Semi-analytic walls [Ferrand 2013, Mayrhofer 2015] need integrals of W over the part of a solid inside a kernel's
// support. The divergence theorem makes each a sum over facets that is exact, at edges and corners too. With x0 the
// kernel's centre and y = x - x0:
//   int_solid grad_i W dV        = -sum_f area_f n_f                     [1/m]
//   int_solid y (x) grad_i W dV  = sum_f (-first_f (x) n_f + solid_f I)  [-]
//   int_solid W dV               = sum_f solid_f                         [-]
// where n_f points out of the solid, into the fluid, and grad_i differentiates with respect to x0
// (docs/conventions.md). For x0 inside the solid sum_f solid_f falls short by 1.
//
// Every kernel is a polynomial in r between its knots, and every integral below has a closed form: nothing is sampled.

#include "core/geometry/swept_sphere.h"
#include "core/sph/kernel.h"

#include <array>
#include <span>

namespace smelt {

/// Coefficients of a polynomial in q = r/h, constant first.
using RadialPolynomial = std::array<double, 9>;

/// One term of a kernel: W h^d = sum of the `shape` of every term whose radius exceeds q. All lengths in units of h.
struct RadialTerm {
  double radius = 0.0;       ///< the knot q at which the term ends
  RadialPolynomial shape{};  ///< f(q), sigma_d included
  RadialPolynomial ring{};   ///< int_q^radius f s ds
  RadialPolynomial ray{};    ///< N(q) = int_q^radius f s^(d-1) ds
  RadialPolynomial cone{};   ///< int_q^radius N s^-2 ds, less cone_pole/q
  double cone_pole = 0.0;
};

/// The radial integrals of one kernel and smoothing length that facet integrals are made of. Immutable: safe to share
/// between threads.
template <int Dim>
class WallKernel {
 public:
  /// `smoothing_length` h in metres, > 0.
  explicit WallKernel(double smoothing_length, KernelType type = KernelType::cubic_spline);

  double smoothing_length() const { return h_; }

  /// R = kappa h [m], beyond which W is 0.
  double support_radius() const { return kappa_ * h_; }

  /// By falling radius; the first reaches to the end of the support.
  std::span<const RadialTerm> terms() const { return {terms_.data(), n_terms_}; }

 private:
  double h_;
  double kappa_;
  std::array<RadialTerm, 3> terms_;
  std::size_t n_terms_ = 0;
};

/// `area` above of an infinite plane at distance d >= 0, and how it changes with the distance.
struct PlaneIntegral {
  double area = 0.0;   ///< A = int W dS [1/m]
  double slope = 0.0;  ///< dA/dd = -2 pi d W(d) [1/m^2]
};
PlaneIntegral integrate_plane(const WallKernel<3>& kernel, double distance);

/// What one facet f adds to the sums above.
template <int Dim>
struct FacetIntegrals {
  double area = 0.0;                  ///< int_f W dS [1/m]
  Vec<Dim> first = Vec<Dim>::Zero();  ///< int_f y W dS [-]
  double solid = 0.0;  ///< int of W over the cone of rays from x0 that lies beyond f [-]; negative behind the facet
};

/// Integrals over `facet` of the kernel centred at `point`; exact but for rounding (2e-13 at worst on random triangles
/// with h = 1, against long double). `normal`: unit, of the facet, on whichever side the caller calls front; the
/// corners may go round either way. In the facet's plane `solid` is its limit from the front along the normal: 1/2 on
/// an infinite wall, also where triangles of one normal meet. On the outline of a wall it jumps, and rounding decides.
/// A facet without extent adds nothing (in 3D: an area below 1e-14 of the longest edge squared), nor does one outside
/// the support.
template <int Dim>
FacetIntegrals<Dim> integrate_facet(const WallKernel<Dim>& kernel, const Simplex<Dim>& facet, const Vec<Dim>& normal,
                                    const Vec<Dim>& point);

/// The same by one point, the facet's centroid, in a tenth of the time (measured: 32 ns for 320 and more): for facets
/// much smaller than h and farther off than their own size. The relative error is of the order of (size/distance)^2.
template <int Dim>
FacetIntegrals<Dim> integrate_small_facet(const WallKernel<Dim>& kernel, const Simplex<Dim>& facet,
                                          const Vec<Dim>& normal, const Vec<Dim>& point);

}  // namespace smelt
