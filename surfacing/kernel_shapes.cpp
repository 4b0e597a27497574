#include "surfacing/kernel_shapes.h"

namespace smelt {

KernelShape isotropic_shape(double h) {
  const auto m = static_cast<float>(1.0 / (h * h)), reach = static_cast<float>(2.0 * h);
  return {{m, m, m, 0.0f, 0.0f, 0.0f}, {reach, reach, reach}, {}, static_cast<float>(1.0 / (h * h * h))};
}

}  // namespace smelt
