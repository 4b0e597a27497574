#pragma once
// Vectors as JSON has them.

#include "core/geometry/vec.h"

#include <nlohmann/json.hpp>

namespace smelt {

/// [x, y, z]
inline nlohmann::ordered_json vector_json(const Vec3& v) {
  return {v[0], v[1], v[2]};
}

}  // namespace smelt
