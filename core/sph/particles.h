#pragma once
// The state of a simulation: everything that a step needs from the one before, and nothing else.

#include "core/geometry/vec.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace smelt {

/// Independent entries of a symmetric Dim x Dim tensor (order in docs/conventions.md).
template <int Dim>
inline constexpr int n_symmetric = Dim*(Dim + 1) / 2;

template <int Dim>
using Symmetric = Eigen::Matrix<double, n_symmetric<Dim>, 1>;

/// Entry (row, column) of the packed symmetric tensor.
template <int Dim>
constexpr int symmetric_index(int row, int column) {
  if (row == column) return row;
  return Dim - 1 + row + column;  // xy = Dim, xz = Dim + 1, yz = Dim + 2
}

/// Row and column of entry `k`, row <= column.
template <int Dim>
constexpr std::pair<int, int> symmetric_entry(int k) {
  if (k < Dim) return {k, k};
  return k - Dim < 2 ? std::pair(0, k - Dim + 1) : std::pair(1, 2);
}

template <int Dim>
Mat<Dim> to_matrix(const Symmetric<Dim>& packed) {
  Mat<Dim> m;
  for (int row = 0; row < Dim; ++row)
    for (int column = 0; column < Dim; ++column) m(row, column) = packed[symmetric_index<Dim>(row, column)];
  return m;
}

template <int Dim>
Symmetric<Dim> to_symmetric(const Mat<Dim>& m) {
  Symmetric<Dim> packed;
  for (int row = 0; row < Dim; ++row)
    for (int column = row; column < Dim; ++column) packed[symmetric_index<Dim>(row, column)] = m(row, column);
  return packed;
}

/// Structure of arrays, one entry per particle. Double precision throughout, so that slow creep and small changes of
/// density do not vanish in rounding. Optional fields are empty where the scene does not use them.
template <int Dim>
struct Particles {
  std::vector<std::int32_t> id;         ///< stable through a shot, none twice
  std::vector<std::uint8_t> material;   ///< index into the materials; empty where there is only one
  std::vector<Vec<Dim>> position;       ///< [m]
  std::vector<Vec<Dim>> velocity;       ///< [m/s]
  std::vector<double> density;          ///< [kg/m^3]
  std::vector<double> temperature;      ///< [K], or empty
  std::vector<double> enthalpy;         ///< specific, from the solid at cold_K on [J/kg]; empty without latent heat
  std::vector<Symmetric<Dim>> stress;   ///< extra stress S [Pa], or empty in an inviscid scene
  std::vector<float> viscosity;         ///< eta = |S| / gdot at the last step [Pa s], or empty in an inviscid scene
  std::vector<double> internal_energy;  ///< of an ideal gas, specific, e [J/kg]; else empty
  std::vector<std::uint8_t> driven;  ///< 1 + the emitter in whose duct it is, or 0; empty in a scene without emitters

  std::size_t size() const { return position.size(); }
};

/// Calls visit(array) for every array of `particles` in a fixed order; `Set` may be const.
template <typename Set, typename Visit>
void for_each_array(Set& particles, const Visit& visit) {
  visit(particles.id);
  visit(particles.material);
  visit(particles.position);
  visit(particles.velocity);
  visit(particles.density);
  visit(particles.temperature);
  visit(particles.enthalpy);
  visit(particles.stress);
  visit(particles.viscosity);
  visit(particles.internal_energy);
  visit(particles.driven);
}

}  // namespace smelt
