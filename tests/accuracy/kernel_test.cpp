// The smoothing kernels: normalisation and gradient, in one, two and three dimensions.

#include "core/sph/kernel.h"

#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace smelt {
namespace {

constexpr double bar = 1e-6;
constexpr std::array<std::pair<KernelType, const char*>, 3> kernels = {{{KernelType::cubic_spline, "cubic spline"},
                                                                        {KernelType::quintic_spline, "quintic spline"},
                                                                        {KernelType::quadratic, "quadratic"}}};

/// |integral of W - 1| by the midpoint rule in the radius.
template <int Dim>
double integral_error(const Kernel<Dim>& kernel) {
  constexpr int n = 20000;
  constexpr double pi = std::numbers::pi;
  const double dr = kernel.support_radius() / n;
  double sum = 0.0;
  for (int k = 0; k < n; ++k) {
    const double r = (k + 0.5) * dr;
    sum += (Dim == 1 ? 2.0 : Dim == 2 ? 2.0 * pi * r : 4.0 * pi * r * r) * kernel.value(r) * dr;
  }
  return std::abs(sum - 1.0);
}

/// |sum V_j W(x - x_j) - 1| at a generic point x of a lattice of `per_h` particles a smoothing length.
template <int Dim>
double unity_error(const Kernel<Dim>& kernel, int per_h) {
  const double spacing = kernel.smoothing_length() / per_h;
  const int reach = static_cast<int>(std::ceil(kernel.support_radius() / spacing)) + 1;
  const double offset[3] = {0.31 * spacing, 0.17 * spacing, 0.43 * spacing};
  const auto square = [&](int k, int axis) { return std::pow(k * spacing - offset[axis], 2); };
  double sum = 0.0;
  for (int k = Dim == 3 ? -reach : 0; k <= (Dim == 3 ? reach : 0); ++k)
    for (int j = Dim >= 2 ? -reach : 0; j <= (Dim >= 2 ? reach : 0); ++j)
      for (int i = -reach; i <= reach; ++i)
        sum +=
            kernel.value(std::sqrt(square(i, 0) + (Dim >= 2 ? square(j, 1) : 0.0) + (Dim == 3 ? square(k, 2) : 0.0)));
  return std::abs(std::pow(spacing, Dim) * sum - 1.0);
}

/// Largest difference between dW/dr x/r and central differences of W, over the largest slope.
template <int Dim>
double gradient_error(const Kernel<Dim>& kernel) {
  const double h = kernel.smoothing_length(), step = 1e-5 * h;
  double direction[3] = {1.0, 0.0, 0.0};
  if (Dim == 2) direction[0] = 0.6, direction[1] = 0.8;
  if (Dim == 3) direction[0] = 0.48, direction[1] = 0.64, direction[2] = 0.6;
  double largest = 0.0, steepest = 0.0;
  for (double r = 0.0137 * h; r < kernel.support_radius() + 0.1 * h; r += 0.0171 * h) {
    for (int axis = 0; axis < Dim; ++axis) {
      const auto value = [&](double shift) {
        double r2 = 0.0;
        for (int a = 0; a < Dim; ++a) r2 += std::pow(r * direction[a] + (a == axis ? shift : 0.0), 2);
        return kernel.value(std::sqrt(r2));
      };
      const double finite = (value(step) - value(-step)) / (2.0 * step);
      largest = std::max(largest, std::abs(kernel.derivative(r) * direction[axis] - finite));
    }
    steepest = std::max(steepest, std::abs(kernel.derivative(r)));
  }
  return largest / steepest;
}

/// One row a quantity: the worst of the kernels.
template <int Dim>
void report_kernels() {
  constexpr int per_h = Dim == 1 ? 1000 : Dim == 2 ? 200 : 40;
  double integral = 0.0, unity = 0.0, gradient = 0.0;
  for (const auto& [type, name] : kernels) {
    SCOPED_TRACE(name);
    const Kernel<Dim> kernel(0.7, type);
    integral = std::max(integral, integral_error(kernel));
    unity = std::max(unity, unity_error(kernel, per_h));
    gradient = std::max(gradient, gradient_error(kernel));
    EXPECT_LE(std::max({integral, unity, gradient}), bar);
  }
  const std::string problem = fmt::format("cubic; quintic and quadratic kernel in {}D", Dim);
  report_row(
      {.problem = problem, .quantity = "integral - 1", .resolution = "20000 shells", .error = integral, .bar = bar});
  report_row({.problem = problem,
              .quantity = "sum V_j W_ij - 1 on a lattice",
              .resolution = fmt::format("{} sites a smoothing length", per_h),
              .error = unity,
              .bar = bar});
  report_row({.problem = problem,
              .quantity = "gradient against finite differences / steepest slope",
              .resolution = "steps of 1e-5 h",
              .error = gradient,
              .bar = bar});
}

TEST(KernelAccuracy, In1D) {
  report_kernels<1>();
}
TEST(KernelAccuracy, In2D) {
  report_kernels<2>();
}
TEST(KernelAccuracy, In3D) {
  report_kernels<3>();
}

}  // namespace
}  // namespace smelt
