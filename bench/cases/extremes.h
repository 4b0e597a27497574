#pragma once
// Scenes at the edge of what the method can be asked: each must end, finite and with no energy from nowhere.

#include "core/sph/solver.h"

#include <functional>
#include <string>
#include <vector>

namespace smelt::extremes {

constexpr double energy_bar = 0.01;       ///< share of the kinetic energy at the start that may appear from nowhere
constexpr double default_courant = 0.25;  ///< C of the time step, the solver's own

struct HardScene {
  Solver<3, float> solver;
  double duration = 0.0;  ///< [s]
};

struct HardCase {
  std::string name;
  std::function<HardScene(double courant)> make;
};

/// A block of 216 particles that spins and stretches, far beyond what its yield stress holds. Its stress is relaxed, or
/// follows the strain rate at once.
HardScene block_with_jump(double jump, bool relaxed, double courant);

/// The same block without gravity, and so slow (shear rates of 1e-3 1/s) that most of its viscosity is that of rest:
/// for ever.
HardScene creeping_block(double jump, bool relaxed, double courant);

/// The jump numbers of the blocks among the hard cases.
const std::vector<double>& jumps();

std::string name_of_block(double jump);

std::vector<HardCase> hard_cases();

/// The one of that name, which must be among them.
HardScene make_hard_scene(const std::string& name, double courant = default_courant);

}  // namespace smelt::extremes
