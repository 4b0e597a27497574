#include "assets/chair.h"

#include "assets/implicit_mesh.h"
#include <cmath>

namespace smelt {

namespace {

constexpr double k = 5.0, a = 0.95, b = 0.8;

double chair_polynomial(const Vec3& x) {
  const double sphere = x.squaredNorm() - a * k * k;
  const double upper = (x[2] - k) * (x[2] - k) - 2.0 * x[0] * x[0], lower = (x[2] + k) * (x[2] + k) - 2.0 * x[1] * x[1];
  return sphere * sphere - b * upper * lower;
}

Vec3 chair_gradient(const Vec3& x) {
  const double sphere = x.squaredNorm() - a * k * k;
  const double upper = (x[2] - k) * (x[2] - k) - 2.0 * x[0] * x[0], lower = (x[2] + k) * (x[2] + k) - 2.0 * x[1] * x[1];
  const Vec3 of_upper(-4.0 * x[0], 0.0, 2.0 * (x[2] - k)), of_lower(0.0, -4.0 * x[1], 2.0 * (x[2] + k));
  return 4.0 * sphere * x - b * (of_upper * lower + upper * of_lower);
}

}  // namespace

TriangleMesh make_chair(double cell) {
  // To first order the distance: nearly linear across a cell. The constant keeps it finite where the gradient vanishes.
  const auto distance = [](const Vec3& x) { return chair_polynomial(x) / std::hypot(chair_gradient(x).norm(), 1.0); };
  Box3 box;
  box.lower = Vec3::Constant(-2.0 * k);
  box.upper = Vec3::Constant(2.0 * k);
  return make_implicit_mesh(distance, box, cell, 10);
}

}  // namespace smelt
