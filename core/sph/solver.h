#pragma once
// The viscoplastic SPH solver  [P Algorithm 3, with the corrections of docs/references.md].

#include "core/sph/collision.h"
#include "core/sph/equation_of_state.h"
#include "core/sph/heat_balance.h"
#include "core/sph/heat_exchange.h"
#include "core/sph/material.h"
#include "core/sph/open_boundary.h"
#include "core/sph/pair_sums.h"
#include "core/sph/particles.h"
#include "core/sph/periodic.h"
#include "core/sph/pressure_sums.h"
#include "core/sph/stress_update.h"
#include "core/sph/time_step.h"
#include "core/sph/walls.h"

#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace smelt {

/// How density is had.
enum class DensityForm {
  continuity,  ///< d rho_i/dt = sum m_j v_ij . grad_w_ij  [P 4-37]: for free surfaces
  summation,   ///< rho_i = sum m_j W_ij, the particle itself included  [S 4.19]: never drifts, but falls off towards a
               ///< free surface
  normalised_summation  ///< that over sum V_j W_ij with V_j = m_j / sum m_k W_jk  [S 4.20]: falls off less
};

template <int Dim>
struct SolverParameters {
  double particle_volume = 0.0;   ///< at rest [m^Dim]; a particle's mass is its material's density times this
  double smoothing_length = 0.0;  ///< h [m]
  KernelType kernel = KernelType::cubic_spline;
  Vec<Dim> gravity = Vec<Dim>::Zero();  ///< [m/s^2]
  double sound_speed = 0.0;  ///< c [m/s] at rest, of the equation of state; an ideal gas has its own and needs none
  EquationOfState equation_of_state;
  DensityForm density = DensityForm::continuity;
  double shear_wave_speed =
      0.0;  ///< sqrt(G/rho0) of the relaxed stress [m/s]; 0: stress follows the strain rate at once
  double artificial_viscosity = 0.0;            ///< alpha of [P 6-15]
  double quadratic_artificial_viscosity = 0.0;  ///< beta of [S 4.40], of an ideal gas alone
  double density_diffusion = 0.0;  ///< delta of [Antuono 2010], on what pressure gradients do not explain; 0.1 to 0.5
  double hourglass_control =
      0.0;            ///< share of the viscosity that acts on motions no gradient sees, 0 to 1; of scenes with a stress
  double xsph = 0.0;  ///< epsilon of [P 6-16]
  /// Density changes with the divergence of the corrected velocity gradient, exact at a free surface
  /// (docs/decisions/0015-thin-flows.md).
  bool corrected_divergence = false;
  double courant = 0.25;        ///< C of the time step
  double min_time_step = 1e-9;  ///< [s]; a smaller one is an error, not a slower simulation
  /// Repeats along each axis whose upper end is above its lower one [m]; empty: none. A particle that leaves through a
  /// face comes in through the opposite one at the next neighbour search. Obstacles do not repeat: they reach beyond
  /// the faces they cross.
  Box<Dim> period;
  std::optional<Ambient> ambient;             ///< what the free surface loses heat to; absent: nothing
  std::vector<HeatSource<Dim>> heat_sources;  ///< what heats the free surface
  Box<Dim> domain;  ///< a particle that leaves it has escaped: an error; empty box: no such check
  /// Reach of the neighbour lists beyond the support, in smoothing lengths; absent: as the particles' motion makes
  /// cheapest.
  std::optional<double> skin;
  std::vector<Emitter<Dim>> emitters;  ///< with the continuity equation alone, up to 255
  std::vector<Outflow<Dim>> outflows;
};

/// The term switches and constants that follow from parameters and materials.
struct SolverTerms {
  PairTerms pair;
  bool relaxed = false;      ///< the stress is relaxed, with the shear wave speed as its stiffness
  bool periodic = false;     ///< some axis repeats
  bool gas = false;          ///< an ideal gas: particles carry internal energy
  bool diffusion = false;    ///< density diffusion
  bool latent_heat = false;  ///< some material takes it up: particles carry their enthalpy
  bool exchange = false;     ///< heat passes through the free surface
  bool ledger = false;       ///< specific heats are known, and so energies

  /// Density diffuses on what the pressure's corrected gradients do not explain, else on what the motion does not
  /// (find_diffusion_gradients).
  bool diffuses_along_gradients() const { return diffusion && pair.stress; }
};

/// What a step is made of, for timing.
enum class StepStage : std::uint8_t {
  kick,         ///< both halves, and the choice of the step
  drift,        ///< with the swept collision
  search,       ///< for neighbours, where it was due
  wall_sums,    ///< which facets each particle sees, and the integrals over them
  records,      ///< what the passes over pairs read, packed twice
  gradients,    ///< of the pressure, where density diffusion asks for them
  rates,        ///< the first pass over pairs, what walls add to it, pressure gradients at these, and by it density,
                ///< heat and stress
  forces,       ///< the second pass over pairs
  wall_forces,  ///< what walls add to it
  watch         ///< particles that come and go, and whether the state is sound
};
inline constexpr std::array step_stage_names{"kick",      "drift", "search", "wall sums",   "records",
                                             "gradients", "rates", "forces", "wall forces", "watch"};

/// A particle that hit a rigid body.
template <int Dim>
struct ParticleHit {
  std::int32_t particle;
  BodyHit<Dim> hit;
};

/// Advances particles in time by leap-frog (kick-drift-kick). Real (float or double) is what the pair loops compute in;
/// the state is double. Results do not depend on the number of threads.
template <int Dim, typename Real>
class Solver {
 public:
  /// What follows from sums over pairs has no more digits than those.
  using RealVec = Eigen::Matrix<Real, Dim, 1>;

  /// Throws Error where the parameters cannot be (non-positive lengths or densities, a periodic box too short; an ideal
  /// gas that is viscous, conducts heat, meets walls or has an adiabatic index of 1 or less; density diffusion of a gas
  /// or of a summed density; no particles and no emitter; latent heat, emissivity, an ambient or sources without
  /// specific heat). The particles of an ideal gas bring their internal energy, those of materials with latent heat
  /// their temperature, and their enthalpy where the temperature does not say it. `account` belongs to particles of a
  /// stored state, and is empty at the start.
  Solver(const SolverParameters<Dim>& parameters, std::vector<Material> materials, Colliders<Dim> colliders,
         Particles<Dim> particles, ParticleAccount account = {});

  /// The state, in the order of the last neighbour search.
  const Particles<Dim>& particles() const { return particles_; }
  Vec<Dim> acceleration(std::size_t i) const;  ///< of particle `i` [m/s^2]; none of what a vent drives
  /// Indices from the number of particles on name periodic images.
  const NeighbourLists& neighbours() const { return lists_; }
  std::size_t n_searches() const { return n_searches_; }  ///< for neighbours, so far
  const Colliders<Dim>& colliders() const { return colliders_; }
  const SolverParameters<Dim>& parameters() const { return parameters_; }
  const std::vector<Material>& materials() const { return materials_; }
  /// What came and went; without entries in a scene without emitters and outflow.
  const ParticleAccount& account() const { return account_; }
  double mass(std::size_t i) const { return material(i).density * parameters_.particle_volume; }  ///< [kg]
  const Material& material(std::size_t i) const {
    return materials_[particles_.material.empty() ? 0 : particles_.material[i]];
  }

  /// Of particle `i`, 0 solid to 1 liquid; of a material with heat.
  double melted_fraction_of(std::size_t i) const;
  /// Specific enthalpy [J/kg] from the solid at cold_K on; of a material whose specific heat is known.
  double enthalpy(std::size_t i) const;
  /// What passed since the last prepare(); all zero where no specific heat is known.
  const HeatLedger& heat_ledger() const { return heat_ledger_; }
  bool knows_enthalpy() const { return terms_.ledger; }
  /// Free surface that each particle stood for when it was last found, less than a fifth of h ago [m^(Dim - 1)]; empty
  /// where no heat passes through it.
  const std::vector<double>& free_surface_area() const { return free_surface_area_; }

  /// Sorts, searches and evaluates the forces anew from the state alone. Called at the start of every frame, so that a
  /// run resumed from a stored state goes on in the same bytes as one that never stopped. `time` [s] tells where moving
  /// obstacles are.
  void prepare(double time = 0.0);

  /// One step of at most `remaining` [s] from `time` [s]. Throws DivergedError with the particle, the term and
  /// the time when a value is not finite, a density is beyond reason, a particle leaves the domain, or the time step
  /// collapses.
  TimeStep step(double remaining, double time);

  /// `ended` is called in every step at the end of each of its stages; nullptr: nobody is.
  void observe(std::function<void(StepStage)> ended) { stage_ended_ = std::move(ended); }

 private:
  void end_stage(StepStage stage) const {
    if (stage_ended_) stage_ended_(stage);
  }
  /// Of the neighbour lists [m].
  double list_reach(double skin) const {
    return (kernel_kappa(parameters_.kernel) + skin) * parameters_.smoothing_length;
  }
  /// The skin that makes search and pairs together cheapest where particles move by `way` [m] a step.
  double best_skin(double way) const;
  double likely_way() const;
  void search_neighbours(double skin);
  void pack_heat(std::size_t i, double largest_conductivity, Real* record) const;
  FlowCurve flow_curve_of(std::size_t i) const;
  void keep_rest_viscosity(std::size_t i, const FlowCurve& curve);
  bool sight_differs() const;
  void pack_motion(bool with_transport);
  void pack_gas(std::size_t i, double dt);
  void copy_records_to_images();
  void sum_densities();
  void set_summed_densities(bool normalise);
  void advance_rates(double dt, double time);
  HeatLedger advance_block(std::size_t begin, std::size_t end, double dt, double time);
  HeatLedger advance_together(std::size_t first, RateSums<Dim, Real>* rates, const SightedSums<Dim, Real>* sighted,
                              double dt, double time, StressBlock<Dim>& stresses);
  void evaluate_pressure_gradients(std::span<const std::int32_t> particles);
  void pack_gradient(std::size_t i, const Vec<Dim>& gradient);
  void find_diffusion_gradients();
  void add_walls(std::size_t begin, std::size_t end, RateSums<Dim, Real>* rates, SightedSums<Dim, Real>* sighted);
  void add_density_diffusion(std::size_t begin, std::size_t end, RateSums<Dim, Real>* rates) const;
  void add_wall_rates(const WallNeighbour<Dim>& wall, RateSums<Dim, Real>& rate, SightedSums<Dim, Real>& sighted) const;
  void collect_stress(std::size_t i, std::size_t k, RateSums<Dim, Real>& rate, const SightedSums<Dim, Real>& sighted,
                      StressBlock<Dim>& stresses);
  void advance_stresses(std::size_t first, double dt, StressBlock<Dim>& stresses);
  void apply_wall_forces(std::size_t slot);
  void sum_body_loads();
  double pressure(std::size_t i) const;
  void set_up_heat();
  void find_free_surface();
  void find_source_powers(double time);
  HeatLedger advance_heat(std::size_t i, double conducted, double dt, double time);
  double exchange_heat(std::size_t i, double dt, double time, double target, HeatLedger& passed) const;
  SurfaceExchange surface_exchange(std::size_t i, double time) const;
  void pack_forces(std::size_t i);
  void pack_stress(std::size_t i, std::size_t k, const StressBlock<Dim>& stresses);
  void pack_hourglass(std::size_t i, std::size_t k, const StressBlock<Dim>& stresses);
  void evaluate_forces();
  void kick(double dt);
  Vec<Dim> mean_velocity() const;
  void drift(double dt);
  void move_particle(std::size_t i, double radius, double dt, Vec<Dim>& transport, std::vector<BodyHit<Dim>>* hits);
  Vec<Dim> drift_particle(std::size_t i, double radius, double dt, std::vector<ParticleHit<Dim>>* hits);
  void strike_bodies();
  double fastest_sound() const;
  double internal_energy(std::size_t i) const { return terms_.gas ? particles_.internal_energy[i] : 0.0; }
  TimeStepInput time_step_input() const;
  TimeStep find_time_step(double remaining, double time) const;
  [[noreturn]] void fail_at_step(const TimeStep& step, double time) const;
  void check_state(double time) const;
  bool is_driven(std::size_t i) const { return !particles_.driven.empty() && particles_.driven[i] != 0; }
  void open_boundaries();
  void match_driven_densities();
  double match_driven_density(std::size_t i) const;
  void exchange_particles(double time);
  void release_driven();
  bool remove_outflow();
  bool pour_in(double time);
  void choose_terms();
  void check_parameters() const;
  void resize_derived();

  SolverParameters<Dim> parameters_;
  std::vector<Material> materials_;
  Colliders<Dim> colliders_;
  Particles<Dim> particles_;
  SolverTerms terms_;
  double spacing_ = 0.0;  ///< of particles at rest [m]
  ParticleAccount account_;
  std::vector<EmitterLayers<Dim>> layers_;  ///< of each emitter

  // Derived from the state.
  NeighbourLists lists_;
  PeriodicImages<Dim> images_;  ///< none without a periodic axis
  PairFields<Dim, Real> fields_;
  std::size_t n_searches_ = 0;
  std::function<void(StepStage)> stage_ended_;
  Vec<Dim> origin_ = Vec<Dim>::Zero();
  double skin_ = 0.0;                  ///< reach of the neighbour lists beyond the support, in smoothing lengths
  double step_way_ = 0.0;              ///< farthest way of any particle against their mean in the last step [m]
  double travelled_at_surface_ = 0.0;  ///< the same since the free surface was found [m]
  double travelled_ = std::numeric_limits<double>::infinity();  ///< farthest way of any particle against their mean
                                                                ///< since the last search [m]
  std::vector<float> clearance_;  ///< at least so far is each particle from all obstacles [m]; empty without any
  std::vector<DensitySums<Real>> density_sums_;  ///< empty where density follows the continuity equation
  std::optional<Walls<Dim>> walls_;              ///< absent where no obstacle is a wall
  std::vector<Vec<Dim>> wall_gradient_;          ///< of the pressure at each wall neighbour [Pa/m]
  std::vector<Real> packed_gradient_;            ///< of the pressure for the diffusion of density; empty without it
  std::vector<double> free_surface_area_;
  std::vector<double> power_density_;  ///< of each heat source of given power at weight 1, at this step [W/m^(Dim - 1)]
  HeatLedger heat_ledger_;
  std::vector<HeatBalance<Dim, Real>> heat_balance_;  ///< empty without heat
  std::vector<Real> rest_viscosity_;     ///< [Pa s]; empty without stresses or where all particles are alike
  std::vector<RealVec> specific_force_;  ///< of pairs and walls [m/s^2]: gravity has more digits
  std::vector<Real> energy_rate_;        ///< of an ideal gas [W/kg], or empty
  std::vector<Vec<Dim>>
      body_forces_;  ///< on each obstacle by each wall neighbour [N]; like the next, empty without rigid bodies
  std::vector<std::vector<ParticleHit<Dim>>> body_hits_;  ///< of the last drift, in blocks of particles
  /// What XSPH adds to the velocity that particles move with, from the rates on; that velocity itself, from the drift
  /// on [m/s]. Empty without.
  std::vector<RealVec> transport_;
};

}  // namespace smelt
