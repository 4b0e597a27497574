#pragma once
// Smoothing kernels W(r, h) [1/m^d] in one, two and three dimensions  [S 4.16-4.17, P 7-25].
//
// With q = r/h every kernel is W = sigma_d f(q), where sigma_d makes its integral 1. `Kernel<Dim>` gives the scalar,
// double-precision form that tests, seeding and diagnostics use; the pair loops have their own vectorised ones.
// The quintic constants correct [S]: 1/(120 h) in 1D (not 120/h) and 1/(120 pi h^3) in 3D (3/(359 pi h^3) is a
// rounding).

#include "core/error.h"

#include <cmath>
#include <numbers>

namespace smelt {

enum class KernelType { cubic_spline, quintic_spline, quadratic };

/// Support radius over smoothing length.
constexpr double kernel_kappa(KernelType type) {
  return type == KernelType::quintic_spline ? 3.0 : 2.0;
}

/// f(q) of the kernel, before normalisation.
inline double kernel_shape(KernelType type, double q) {
  const auto power = [](double x, int n) { return x > 0.0 ? std::pow(x, n) : 0.0; };
  switch (type) {
    case KernelType::cubic_spline:
      return 0.25 * power(2.0 - q, 3) - power(1.0 - q, 3);
    case KernelType::quintic_spline:
      return power(3.0 - q, 5) - 6.0 * power(2.0 - q, 5) + 15.0 * power(1.0 - q, 5);
    case KernelType::quadratic:
      return q < 2.0 ? 3.0 / 16.0 * q * q - 0.75 * q + 0.75 : 0.0;
  }
  throw InternalError("kernel_shape: unknown kernel");
}

/// df/dq.
inline double kernel_slope(KernelType type, double q) {
  const auto power = [](double x, int n) { return x > 0.0 ? std::pow(x, n) : 0.0; };
  switch (type) {
    case KernelType::cubic_spline:
      return -0.75 * power(2.0 - q, 2) + 3.0 * power(1.0 - q, 2);
    case KernelType::quintic_spline:
      return -5.0 * power(3.0 - q, 4) + 30.0 * power(2.0 - q, 4) - 75.0 * power(1.0 - q, 4);
    case KernelType::quadratic:
      return q < 2.0 ? 3.0 / 8.0 * q - 0.75 : 0.0;
  }
  throw InternalError("kernel_slope: unknown kernel");
}

/// sigma_d h^d, the normalisation for h = 1.
template <int Dim>
double kernel_normalisation(KernelType type) {
  constexpr double pi = std::numbers::pi;
  switch (type) {
    case KernelType::cubic_spline:
      return Dim == 1 ? 2.0 / 3.0 : Dim == 2 ? 10.0 / (7.0 * pi) : 1.0 / pi;
    case KernelType::quintic_spline:
      return Dim == 1 ? 1.0 / 120.0 : Dim == 2 ? 7.0 / (478.0 * pi) : 1.0 / (120.0 * pi);
    case KernelType::quadratic:
      return Dim == 1 ? 1.0 : Dim == 2 ? 2.0 / pi : 5.0 / (4.0 * pi);
  }
  throw InternalError("kernel_normalisation: unknown kernel");
}

/// W(r, h) and its gradient for one smoothing length.
template <int Dim>
class Kernel {
 public:
  /// `smoothing_length` h in metres, > 0.
  explicit Kernel(double smoothing_length, KernelType type = KernelType::cubic_spline)
      : type_(type), h_(smoothing_length), sigma_(kernel_normalisation<Dim>(type) / std::pow(smoothing_length, Dim)) {
    CHECK_GT(smoothing_length, 0.0);
  }

  double smoothing_length() const { return h_; }
  double support_radius() const { return kernel_kappa(type_) * h_; }

  /// W(r) [1/m^d].
  double value(double r) const { return sigma_ * kernel_shape(type_, r / h_); }

  /// dW/dr [1/m^(d+1)]; grad_w_ij = derivative(r) x_ij / r.
  double derivative(double r) const { return sigma_ / h_ * kernel_slope(type_, r / h_); }

 private:
  KernelType type_;
  double h_;
  double sigma_;
};

}  // namespace smelt
