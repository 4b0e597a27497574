#pragma once
// The passes over neighbour pairs, vectorised: rates and forces, and one for densities that are sums. Everything else
// in a step is per particle.
//
// Symbols: x_ij = x_i - x_j, v_ij = v_i - v_j, V_j = m_j/rho_j, W the kernel, F = (dW/dr)/r, so grad_w_ij = F x_ij.
// Each pair is evaluated from both of its particles (no scattered writes), so results do not depend on threads.

#include "core/error.h"
#include "core/sph/kernel.h"
#include "core/sph/neighbours.h"

#include <tbb/cache_aligned_allocator.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace smelt {

/// Conduction in the pair loops.
enum class HeatTerms : std::uint8_t {
  none,
  uniform,  ///< all particles conduct equally well
  mixed     ///< conductivities differ: their harmonic mean is taken pair by pair
};

/// What a scene asks of the pair loops; an unused term costs neither time nor memory.
struct PairTerms {
  KernelType kernel = KernelType::cubic_spline;
  bool stress = false;
  bool hourglass = false;  ///< hourglass control, of a stress
  bool sight = false;  ///< some particles are far thinner than others (sight_of_thinner): a stress does not see them
                       ///< from the stiff ones
  HeatTerms heat = HeatTerms::none;
  bool xsph = false;

  bool has_heat() const { return heat != HeatTerms::none; }
};

/// A stress is made from a velocity gradient over neighbours, each weighted by its sight w_ij = min(1, sight_of_thinner
/// eta_j/eta_i), eta the viscosity at rest: a solid does not take the flow of a liquid over it for its own shear
/// (docs/decisions/0033-solid-under-a-flow.md).
inline constexpr double sight_of_thinner = 10.0;

/// Fields padded to whole groups of four: a vector of neighbours is loaded group by group and transposed, which costs a
/// fraction of gathering field by field (docs/decisions/0006-pair-loops.md).
constexpr int padded_fields(int n_fields) {
  return (n_fields + 3) / 4 * 4;
}

/// Numbers in a record of the pair loops: a cache line in single precision.
inline constexpr int pair_record_size = 16;

/// The particles as the pair loops read them, in the order of the neighbour lists: a record each and, where there is a
/// stress, a record of it, both of one cache line (in single precision). They lie apart, as the first pass reads the
/// first alone. Positions are relative to an origin near the particles, so that Real may be float. Fields of unused
/// terms are not read.
template <int Dim, typename Real>
struct PairFields {
  /// Position [m] is first, then velocity [m/s], volume V [m^Dim], density rho [kg/m^Dim].
  static constexpr int n_motion = 2 * Dim + 2;
  static constexpr int velocity_at = Dim, volume_at = 2 * Dim, density_at = 2 * Dim + 1;
  /// Temperature above a reference [K], conductivity over c_p relative to the scene's largest [-], and of the pass
  /// before 1/theta, theta the moment trace [-], and the balance lambda [1/m] (core/sph/heat_balance.h).
  static constexpr int heat_at = 8, n_heat = 3 + Dim;
  static constexpr int conductivity_at = heat_at + 1, inverse_trace_at = heat_at + 2, balance_at = heat_at + 3;
  /// p/rho^2 [Pa m^(2 Dim)/kg^2], and p [Pa] of a liquid or the sound speed [m/s] of an ideal gas.
  static constexpr int specific_pressure_at = 14, pressure_at = 15, sound_speed_at = 15;
  /// Where sight differs, viscosity at rest eta [Pa s]: in the first pass, and in the second, which reads no heat,
  /// followed by 1/eta.
  static constexpr int rest_viscosity_at = 14, rest_viscosity_of_forces_at = 12;
  static constexpr int record_size = pair_record_size;

  /// A record of stress begins with S L row-major [Pa]. With hourglass control, then eta_h/2 [Pa s] and eta_h E/2 [Pa],
  /// E the symmetric velocity gradient, packed, its off-diagonal entries doubled.
  static constexpr int hourglass_at = Dim * Dim;
  static constexpr int n_stress(bool with_hourglass) {
    return Dim * Dim + (with_hourglass ? 1 + Dim * (Dim + 1) / 2 : 0);
  }
  static_assert(n_stress(true) <= record_size);

  /// n records, then as many of stress where there is one. Both are as long, so that a neighbour's lies as far behind
  /// its record as any other's.
  std::vector<Real, tbb::cache_aligned_allocator<Real>> records;
  std::ptrdiff_t stresses_at = 0;

  /// Makes room for `n` particles.
  void resize(std::size_t n, bool with_stress) {
    CHECK_LE(n, (std::size_t{1} << 32) / record_size);  // rows of neighbours say where records begin
    records.resize((with_stress ? 2 : 1) * n * record_size);
    stresses_at = static_cast<std::ptrdiff_t>(n * record_size);
  }
  Real* record(std::size_t i) { return records.data() + i * record_size; }
  const Real* record(std::size_t i) const { return records.data() + i * record_size; }
  Real* stress(std::size_t i) { return record(i) + stresses_at; }
  const Real* stress(std::size_t i) const { return record(i) + stresses_at; }

  /// The row of particle `i`: where the records of its neighbours begin.
  NeighbourLists::Row read_row(const NeighbourLists& lists, std::size_t i, std::int32_t* buffer) const {
    return lists.read<record_size>(i, buffer);
  }
};

/// Sums of the first pass for one particle.
template <int Dim, typename Real>
struct RateSums {
  Real density_rate;  ///< sum m_j v_ij . grad_w_ij  [P 4-37]
  std::array<Real, Dim * Dim>
      velocity_moment;  ///< sum V_j (v_j - v_i) (x) grad_w_ij, row-major (bare velocity gradient)
  std::array<Real, Dim*(Dim + 1) / 2>
      position_moment;  ///< sum V_j (x_j - x_i) (x) grad_w_ij  [Bonet & Lok 1999]; of stress or heat
  /// 2 sum V_j (T_i - T_j) F b_ij / theta_ij, finite at r = 0  [P 6-9, corrected], with the balance b_ij = 1 +
  /// x_ij.(lambda_i - lambda_j), held within [0.2, 1.8], and 1/theta_ij the mean of the particles' 1/theta
  /// (core/sph/heat_balance.h); where conductivities l differ, each pair times 2 l_j/(l_i + l_j), so that l_i times it
  /// has their harmonic mean  [Cleary & Monaghan 1999]
  Real heat;
  Real moment_trace;                     ///< theta = - sum V_j r^2 F b_ij / Dim
  std::array<Real, Dim> heat_imbalance;  ///< sum V_j F x_ij (1 - x_ij.lambda_j) [1/m]
  std::array<Real, Dim> xsph;  ///< sum m_j (1/rho_i + 1/rho_j)/2 (v_j - v_i) W_ij  [P 6-16, whose 2/(rho_i + rho_j)
                               ///< takes a division a pair and differs by (rho_i - rho_j)^2]
};

/// Neighbours in the longest vector: rows of the neighbour lists are padded to a multiple of it, on every machine.
template <typename Real>
inline constexpr int pair_lanes = 64 / static_cast<int>(sizeof(Real));

/// What a stress sees where sight differs.
template <int Dim, typename Real>
struct SightedSums {
  std::array<Real, Dim * Dim> velocity_moment;          ///< sum V_j w_ij (v_j - v_i) (x) grad_w_ij, row-major
  std::array<Real, Dim*(Dim + 1) / 2> position_moment;  ///< sum V_j w_ij (x_j - x_i) (x) grad_w_ij
};

/// First pass for particles [begin, end): rates of density, velocity gradient, heat and XSPH from `fields.velocity`.
/// `smoothing_length` in metres. `sums` has one entry for each of them, and so has `sighted` where the terms have
/// sight.
template <int Dim, typename Real>
void compute_rate_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, const PairTerms& terms,
                       double smoothing_length, std::size_t begin, std::size_t end, RateSums<Dim, Real>* sums,
                       SightedSums<Dim, Real>* sighted = nullptr);

/// Sums over all particles in reach and the particle itself.
template <typename Real>
struct DensitySums {
  Real mass;    ///< sum m_j W_ij, the density by summation [kg/m^Dim]  [S 4.19]
  Real volume;  ///< sum V_j W_ij, about 1 where the support is full  [S 4.20]
};

/// The pass before the others where density is a sum: for particles [begin, end), from positions, volumes and densities
/// in `fields`. `sums` has one entry for each of them.
template <int Dim, typename Real>
void compute_density_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, KernelType kernel,
                          double smoothing_length, std::size_t begin, std::size_t end, DensitySums<Real>* sums);

/// Strength of the pairwise forces.
struct ForceParameters {
  double smoothing_length = 0.0;      ///< h [m]
  double artificial_viscosity = 0.0;  ///< alpha [-]
  double sound_speed = 0.0;           ///< c [m/s]
};

/// Second pass for particles [begin, end): the accelerations [m/s^2], one entry for each of them,
///   - sum m_j (p_i/rho_i^2 + p_j/rho_j^2 + Pi_ij) grad_w_ij + sum m_j/(rho_i rho_j) (w_ij S_i L_i + w_ji S_j L_j)
///     grad_w_ij
/// of [P 4-38, 4-46, 6-14 corrected: Pi_ij already divides by a density], with Pi_ij of [P 6-15]. L is the inverse of
/// the position moment: with it the force is the adjoint of the corrected gradient, so it does no work on a rigid
/// motion and conserves linear and angular momentum [Bonet & Lok 1999]. Hourglass control adds
///   2 (Dim + 2) sum V_j/rho_i [ (eta_i + eta_j)/2 v_ij.x_ij - x_ij.(eta_i E_i + eta_j E_j)/2 x_ij ] / (r^2 + 0.01 h^2)
///   grad_w_ij
/// (eta_i and eta_j times w_ij and w_ji, too),
/// the pairwise viscosity of [Monaghan & Gingold 1983] on what the gradients do not see of the velocities: nothing
/// where the field is linear, a fourth derivative where it is smooth, and friction for motions of the lattice that no
/// gradient resists (docs/decisions/0009-hourglass-control.md, after [Ganzenmueller 2015]).
template <int Dim, typename Real>
void compute_force_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, const PairTerms& terms,
                        const ForceParameters& parameters, std::size_t begin, std::size_t end,
                        std::array<Real, Dim>* acceleration);

/// Strength of the artificial viscosity of a gas, Pi_ij = (-alpha c_ij mu_ij + beta mu_ij^2)/rho_ij where particles
/// approach, else 0, with mu_ij = h v_ij.x_ij/(r^2 + 0.01 h^2) and c_ij, rho_ij the pair's means  [S 4.40-4.46; 4.41
/// has r for r^2].
struct GasForceParameters {
  double smoothing_length = 0.0;                ///< h [m]
  double artificial_viscosity = 0.0;            ///< alpha [-]
  double quadratic_artificial_viscosity = 0.0;  ///< beta [-]
};

/// Second pass of an ideal gas for particles [begin, end): the accelerations - sum m_j (p_i/rho_i^2 + p_j/rho_j^2 +
/// Pi_ij) grad_w_ij [m/s^2], and 1/2 sum m_j (p_i/rho_i^2 + p_j/rho_j^2 + Pi_ij) v_ij.grad_w_ij, the rate of specific
/// internal energy [W/kg], which is what kinetic energy loses  [S 4.47-4.48]; one entry for each of them.
template <int Dim, typename Real>
void compute_gas_force_sums(const PairFields<Dim, Real>& fields, const NeighbourLists& lists, KernelType kernel,
                            const GasForceParameters& parameters, std::size_t begin, std::size_t end,
                            std::array<Real, Dim>* acceleration, Real* energy_rate);

}  // namespace smelt
