#pragma once
// The particles of one frame, as caches hold them and as surfacing and rendering read them.

#include "core/geometry/vec.h"

#include <cstdint>
#include <vector>

namespace smelt {

/// Structure of arrays, one entry per particle; optional fields are empty where the scene has none. Ordered by `id`.
struct ParticleFrame {
  std::vector<Vec3> position;      ///< [m]
  std::vector<Vec3f> velocity;     ///< [m/s]
  std::vector<float> density;      ///< [kg/m^3]
  std::vector<float> temperature;  ///< [K], or empty
  std::vector<float> viscosity;    ///< [Pa s], or empty
  std::vector<float> masses;       ///< [kg], or empty where all are `mass`
  std::vector<Vec3f> rest;         ///< where it was in the unmoved material [m], or empty
  std::vector<std::int32_t> id;    ///< stable through a shot

  double mass = 0.0;              ///< of one particle [kg]; of the first where they differ
  double spacing = 0.0;           ///< initial distance between particles [m]
  double smoothing_length = 0.0;  ///< h of the simulation [m]; the kernel's support radius is 2 h
  std::int32_t frame = 0;         ///< counted from 1
  double time = 0.0;              ///< [s]

  std::size_t size() const { return position.size(); }
  double mass_of(std::size_t i) const { return masses.empty() ? mass : static_cast<double>(masses[i]); }
};

}  // namespace smelt
