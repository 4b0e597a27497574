#pragma once
// Where particles come in and go out while a simulation runs (docs/decisions/0012-emitters.md).
//
// A vent is a short duct of circular section. Layers of a square lattice come in at its root behind its entry, one
// spacing apart, and are driven through it with the velocity that the flow rate asks for; where they leave it they are
// free. So what is free has its support full of particles that move as it does, and none appears beside it.

#include "core/geometry/vec.h"

#include <cstdint>
#include <vector>

namespace smelt {

/// A vent.
template <int Dim>
struct Emitter {
  Vec<Dim> position = Vec<Dim>::Zero();    ///< middle of the entry [m]
  Vec<Dim> direction = Vec<Dim>::Unit(0);  ///< of the flow, unit
  double radius = 0.0;                     ///< of the section [m]
  double root = 0.0;         ///< how far behind the entry layers come in, in the ground perhaps; a spacing at least [m]
  double flow_rate = 0.0;    ///< [m^Dim/s]
  double start = 0.0;        ///< when the flow enters, and [s]
  double end = 0.0;          ///< when it stops entering, infinity: never; what is in the duct still leaves it
  double temperature = 0.0;  ///< [K]; of scenes with heat
  std::uint8_t material = 0;
};

/// How an emitter's flow is cut into particles.
template <int Dim>
struct EmitterLayers {
  std::vector<Vec<Dim>> sites;  ///< of a layer, from `position` [m], those nearest to the axis first
  double speed = 0.0;           ///< flow rate over the section of the sites [m/s]
  double period = 0.0;          ///< from one layer to the next: a spacing at that speed [s]
  double root = 0.0;            ///< as the emitter's, in whole spacings [m]
  double depth = 0.0;  ///< length of the duct from `position` on [m]: whole spacings, at least the kernel's support
  std::int64_t n_particles = 0;  ///< in all: the poured volume over that of a particle, rounded
};

/// Throws Error where the radius is below the spacing, the flow rate is not positive, the direction is no unit vector
/// or the end is not after the start. `particle_volume` [m^Dim], `support_radius` [m].
template <int Dim>
EmitterLayers<Dim> compute_emitter_layers(const Emitter<Dim>& emitter, double particle_volume, double support_radius);

/// How many particles have entered by `time` [s]. The layer k comes in at start + (k + 1/2) periods, when half of its
/// volume has; the last one may lack sites. So the volume entered differs from rate times time by half a layer at most,
/// and in the end by half a particle.
template <int Dim>
std::int64_t count_entered(const Emitter<Dim>& emitter, const EmitterLayers<Dim>& layers, double time);

/// Where particle number `k` of an emitter is at `time` [s] while it is driven [m].
template <int Dim>
Vec<Dim> entered_position(const Emitter<Dim>& emitter, const EmitterLayers<Dim>& layers, std::int64_t k, double time);

/// Takes particles out of the simulation.
template <int Dim>
struct Outflow {
  Box<Dim> box;
  bool outside = false;  ///< those outside the box, else those inside

  bool removes(const Vec<Dim>& x) const {
    const bool is_outside = (x.array() < box.lower.array()).any() || (x.array() > box.upper.array()).any();
    const bool is_inside = (x.array() >= box.lower.array()).all() && (x.array() <= box.upper.array()).all();
    return outside ? is_outside : is_inside;  // what is not a number is neither
  }
};

/// What came and went since the start, counted in particles: whole numbers, so that no mass is lost in rounding.
struct ParticleAccount {
  std::int32_t next_id = 0;
  std::vector<std::int64_t>
      initial;  ///< of each material; empty in a scene without emitters and outflow, like the next two
  std::vector<std::int64_t> removed;  ///< of each material
  std::vector<std::int64_t> entered;  ///< of each emitter
};

}  // namespace smelt
