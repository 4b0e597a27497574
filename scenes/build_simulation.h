#pragma once
// From a scene to particles, colliders and solver parameters.

#include "core/geometry/repair.h"
#include "core/sph/solver.h"
#include "scenes/scene.h"

#include <string>
#include <vector>

namespace smelt {

/// A simulation ready to start, at frame 1.
struct SimulationSetup {
  Particles<3> particles;  ///< none where all of them are poured in
  SolverParameters<3> parameters;
  std::vector<Material> materials;
  std::vector<TriangleMesh> colliders;  ///< placed in the world [m], one a [[collider]]
  std::vector<Obstacle<3>> obstacles;   ///< what each of them does; without the facets, which are the mesh's
  double spacing = 0.0;                 ///< between particles [m]
  double body_volume = 0.0;             ///< of all bodies' meshes [m^3]
  Box3 body_bounds;                     ///< of all bodies' meshes [m]
  double fastest_start = 0.0;           ///< of bodies, colliders, emitters [m/s]
  double expected_speed = 0.0;          ///< at most: of a fall through the whole scene after the fastest start [m/s]
  std::vector<std::string> warnings;    ///< what was mended in meshes, left out, or looks wrong
};

/// Imports, places, mends and fills the meshes. Throws Error with the mesh's file for those that cannot be used, and
/// for bodies that start under the ground or half in a vessel.
SimulationSetup build_simulation(const Scene& scene);

/// The obstacles as the solver wants them.
Colliders<3> build_colliders(const SimulationSetup& setup);

/// The bodies' meshes where the scene puts them, as imported: not mended, perhaps open. Throws Error with the mesh's
/// file.
std::vector<TriangleMesh> import_placed_bodies(const Scene& scene);

/// The mesh of a collider that is not `ground`, where the scene puts it. Throws Error with the mesh's file.
TriangleMesh import_placed_collider(const Scene& scene, std::size_t k);

/// Side of a cube of all that an emitter pours during the shot [m].
double pile_size(const Scene& scene, const EmitterSettings& emitter);

/// Particles that the emitters will have poured in after `seconds` of a shot.
double count_poured(const SimulationSetup& setup, double seconds);

/// What a scene's flow law comes to. An exponential holds from cold_K to hot_K of `heat`.
Rheology to_rheology(const ViscositySettings& settings, const std::optional<HeatProperties>& heat);

}  // namespace smelt
