#pragma once
// Pictures of flows in a plane.

#include "bench/cases/case.h"
#include "core/sph/particles.h"

#include <string>

namespace smelt {

/// Particles where they are, in units of `length` [m], which the labels name, coloured by speed.
inline Picture draw_speeds(const Particles<2>& p, const std::string& caption, double length = 1.0,
                           const std::string& unit = "[m]") {
  Picture picture{.caption = caption, .x_label = "x " + unit, .y_label = "y " + unit, .value_label = "speed [m/s]"};
  for (std::size_t i = 0; i < p.size(); ++i) {
    picture.x.push_back(p.position[i][0] / length);
    picture.y.push_back(p.position[i][1] / length);
    picture.value.push_back(p.velocity[i].norm());
  }
  return picture;
}

}  // namespace smelt
