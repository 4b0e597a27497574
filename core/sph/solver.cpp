#include "core/sph/solver.h"

#include "core/error.h"
#include "core/parallel.h"
#include "core/round_down.h"
#include "core/sph/kernel.h"
#include "core/sph/reorder.h"
#include "core/sph/wall_terms.h"

#include <algorithm>
#include <cmath>
#include <memory_resource>
#include <numbers>
#include <utility>

namespace smelt {

namespace {

bool inviscid(const Rheology& r) {
  return is_zero(r.yield_stress) && is_zero(r.consistency);
}

/// Whether materials conduct, and whether all of them equally well.
HeatTerms heat_terms(const std::vector<Material>& materials) {
  const auto conducts = [](const Material& m) { return m.heat.has_value(); };
  if (std::none_of(materials.begin(), materials.end(), conducts)) return HeatTerms::none;
  const auto like_first = [&](const Material& m) {
    return m.heat && materials.front().heat && conductivity(m) == conductivity(materials.front());
  };
  return std::all_of(materials.begin(), materials.end(), like_first) ? HeatTerms::uniform : HeatTerms::mixed;
}

/// Radius of the sphere (disc, segment) of a particle's volume  [P 5-11].
template <int Dim>
double particle_radius(double volume) {
  constexpr double pi = std::numbers::pi;
  return Dim == 3 ? std::cbrt(0.75 * volume / pi) : Dim == 2 ? std::sqrt(volume / pi) : 0.5 * volume;
}

}  // namespace

template <int Dim, typename Real>
Solver<Dim, Real>::Solver(const SolverParameters<Dim>& parameters, std::vector<Material> materials,
                          Colliders<Dim> colliders, Particles<Dim> particles, ParticleAccount account)
    : parameters_(parameters),
      materials_(std::move(materials)),
      colliders_(std::move(colliders)),
      particles_(std::move(particles)),
      account_(std::move(account)) {
  const std::size_t n = particles_.size();
  CHECK_EQ(particles_.density.size(), n);
  choose_terms();
  check_parameters();
  spacing_ = std::pow(parameters_.particle_volume, 1.0 / Dim);
  check_period<Dim>(parameters_.period, list_reach(best_skin(0.0)));
  CHECK_EQ(particles_.temperature.size(), terms_.pair.has_heat() ? n : 0);
  CHECK_EQ(particles_.internal_energy.size(), terms_.gas ? n : 0);
  set_up_heat();
  if (terms_.pair.stress) {
    particles_.stress.resize(n, Symmetric<Dim>::Zero());
    particles_.viscosity.resize(n, 0.0F);
  }
  if (colliders_.has_walls())
    walls_.emplace(WallKernel<Dim>(parameters_.smoothing_length, parameters_.kernel), spacing_,
                   Colliders<Dim>::wall_guard * particle_radius<Dim>(parameters_.particle_volume));
  open_boundaries();
  resize_derived();
}

/// What this scene needs of the equations, and so of memory and time.
template <int Dim, typename Real>
void Solver<Dim, Real>::choose_terms() {
  terms_.gas = parameters_.equation_of_state.law == PressureLaw::ideal_gas;
  terms_.pair.kernel = parameters_.kernel;
  terms_.pair.stress =
      std::any_of(materials_.begin(), materials_.end(), [](const Material& m) { return !inviscid(m.rheology); });
  terms_.pair.heat = heat_terms(materials_);
  terms_.pair.xsph = parameters_.xsph > 0.0;
  for (int a = 0; a < Dim; ++a) terms_.periodic = terms_.periodic || is_periodic(parameters_.period, a);
  terms_.relaxed = terms_.pair.stress && parameters_.shear_wave_speed > 0.0;
  terms_.pair.hourglass = terms_.pair.stress && parameters_.hourglass_control > 0.0;
  terms_.diffusion = parameters_.density_diffusion > 0.0;
}

/// All that is kept per particle beside the state.
template <int Dim, typename Real>
void Solver<Dim, Real>::resize_derived() {
  const std::size_t n = particles_.size();
  specific_force_.resize(n, RealVec::Zero());
  if (terms_.gas) energy_rate_.resize(n);
  if (terms_.pair.has_heat()) heat_balance_.resize(n);
  if (terms_.pair.xsph) transport_.resize(n, RealVec::Zero());
  if (!colliders_.empty()) clearance_.resize(n, 0.0F);
  if (terms_.exchange) free_surface_area_.resize(n, 0.0);
  // Of one material, without heat, all particles are alike.
  if (terms_.pair.stress && (terms_.pair.has_heat() || materials_.size() > 1)) {
    const std::size_t before = rest_viscosity_.size();
    rest_viscosity_.resize(n);
    for (std::size_t i = before; i < n; ++i) keep_rest_viscosity(i, flow_curve_of(i));
  }
}

// ------------------------------------------------------------------------------------------------------- the algorithm

template <int Dim, typename Real>
void Solver<Dim, Real>::prepare(double time) {
  colliders_.place_at(time);
  if (terms_.pair.has_heat()) heat_balance_.assign(particles_.size(), {});
  std::fill(clearance_.begin(), clearance_.end(), 0.0F);
  if (walls_) walls_->reset(particles_.size());
  search_neighbours(best_skin(likely_way()));
  if (walls_) walls_->update(colliders_, particles_.position, particles_.velocity, 0.0);
  if (terms_.exchange) find_free_surface();
  heat_ledger_ = {};
  pack_motion(false);
  sum_densities();
  advance_rates(0.0, time);
  evaluate_forces();
}

template <int Dim, typename Real>
TimeStep Solver<Dim, Real>::step(double remaining, double time) {
  const TimeStep limit = find_time_step(remaining, time);
  if (!(limit.dt >= parameters_.min_time_step)) fail_at_step(limit, time);
  const TimeStep step = fit_to_frame(limit, remaining);
  const double dt = step.dt;

  // Leap-frog: half a kick, a whole drift, half a kick.
  kick(0.5 * dt);
  end_stage(StepStage::kick);
  colliders_.begin_step(time, dt);
  drift(dt);
  if (colliders_.end_step()) {
    travelled_ = travelled_at_surface_ = std::numeric_limits<double>::infinity();
    if (walls_) walls_->reset(particles_.size());  // they saw an obstacle that is not there
  }
  if (colliders_.has_bodies()) strike_bodies();
  end_stage(StepStage::drift);

  if (2.0 * travelled_ > skin_ * parameters_.smoothing_length) search_neighbours(best_skin(step_way_));
  end_stage(StepStage::search);
  if (walls_) walls_->update(colliders_, particles_.position, particles_.velocity, dt);
  if (terms_.exchange && travelled_at_surface_ > 0.2 * parameters_.smoothing_length) find_free_surface();
  end_stage(StepStage::wall_sums);

  // Density, heat and stress change with the velocity that moved the particles.
  pack_motion(terms_.pair.xsph);
  sum_densities();
  advance_rates(dt, time + dt);
  evaluate_forces();
  kick(0.5 * dt);
  end_stage(StepStage::kick);

  exchange_particles(time + dt);
  check_state(time + dt);
  end_stage(StepStage::watch);
  return step;
}

// ---------------------------------------------------------------------------------------------------------- neighbours

/// Pairs cost P (1 + skin/kappa)^3 a step, searches S/(skin h/2 way). With S about P, as measured on a melting heap,
/// the sum is least about here. In a periodic box the reach is bounded by its size.
template <int Dim, typename Real>
double Solver<Dim, Real>::best_skin(double way) const {
  constexpr double in_a_box = 0.08, least = 0.02, most = 0.35;
  if (parameters_.skin) return *parameters_.skin;
  if (terms_.periodic) return in_a_box;
  return std::clamp(1.2 * std::sqrt(way / parameters_.smoothing_length), least, most);
}

/// What the fastest particle may move by in a step against their mean [m], from the state alone.
template <int Dim, typename Real>
double Solver<Dim, Real>::likely_way() const {
  const Vec<Dim> mean = mean_velocity();
  const double fastest2 = deterministic_reduce(
      particles_.size(), 0.0, [&](std::size_t i) { return (particles_.velocity[i] - mean).squaredNorm(); },
      [](double a, double b) { return std::max(a, b); });
  if (fastest2 == 0.0) return 0.0;
  const double fastest = std::sqrt(fastest2);
  return parameters_.courant * parameters_.smoothing_length * fastest / (fastest + fastest_sound());
}

template <int Dim, typename Real>
void Solver<Dim, Real>::search_neighbours(double skin) {
  skin_ = skin;
  const double radius = list_reach(skin);
  if (terms_.periodic) wrap_positions<Dim>(parameters_.period, particles_.position);
  // The records are packed anew after a search: until then their memory is free, with one more record for what
  // alignment takes.
  const std::size_t n = particles_.size();
  fields_.resize(n + 1, terms_.pair.stress);
  const std::span<std::byte> scratch = std::as_writable_bytes(std::span(fields_.records));
  const std::size_t for_order = n * (sizeof(std::uint64_t) + sizeof(std::int32_t)) + 64;
  std::pmr::monotonic_buffer_resource memory(scratch.data(), for_order);
  const auto order = compute_cell_order<Dim>(particles_.position, particles_.id, radius, &memory);
  const auto reorder = [&](auto& values) { smelt::reorder(values, order, scratch.subspan(for_order)); };
  for_each_array(particles_, reorder);
  reorder(transport_);
  reorder(heat_balance_);
  reorder(rest_viscosity_);
  if (terms_.periodic) std::fill(clearance_.begin(), clearance_.end(), 0.0F);  // of places across the box
  reorder(clearance_);
  reorder(free_surface_area_);
  // The rates of the last step look half a kick ahead (pack_gas), or say what gradient balances them
  // (evaluate_pressure_gradients).
  if (terms_.gas || terms_.diffusion) reorder(specific_force_);
  if (terms_.gas) reorder(energy_rate_);
  // In a periodic box particles came from across it.
  if (walls_ && terms_.periodic) walls_->reset(n);
  if (walls_ && !terms_.periodic) walls_->reorder(order, scratch.subspan(for_order));
  if (terms_.periodic)
    images_ = build_periodic_neighbour_lists<Dim>(parameters_.period, particles_.position, particles_.id, radius,
                                                  pair_lanes<Real>, lists_);
  else
    build_neighbour_lists<Dim>(particles_.position, radius, radius, pair_lanes<Real>, lists_);
  // The middle of the particles: what single precision resolves there is relative to their extent.
  origin_ = bounds_of<Dim>(particles_.position).centre();
  travelled_ = 0.0;
  ++n_searches_;
}

// -------------------------------------------------------------------------------------------------------------- forces

template <int Dim, typename Real>
void Solver<Dim, Real>::evaluate_forces() {
  const ForceParameters force{parameters_.smoothing_length, parameters_.artificial_viscosity, parameters_.sound_speed};
  const GasForceParameters gas{parameters_.smoothing_length, parameters_.artificial_viscosity,
                               parameters_.quadratic_artificial_viscosity};
  parallel_blocks(particles_.size(), [&](std::size_t begin, std::size_t end) {
    std::array<std::array<Real, Dim>, block_size> sums;
    if (terms_.gas)
      compute_gas_force_sums<Dim, Real>(fields_, lists_, terms_.pair.kernel, gas, begin, end, sums.data(),
                                        energy_rate_.data() + begin);
    else
      compute_force_sums<Dim, Real>(fields_, lists_, terms_.pair, force, begin, end, sums.data());
    for (std::size_t i = begin; i < end; ++i)
      for (int a = 0; a < Dim; ++a) specific_force_[i][a] = sums[i - begin][a];
  });
  end_stage(StepStage::forces);
  if (walls_) {
    const std::size_t n_walled = walls_->neighbours().size();
    if (colliders_.has_bodies()) body_forces_.assign(n_walled * colliders_.placed().size(), Vec<Dim>::Zero());
    parallel_for_each(n_walled, [&](std::size_t slot) { apply_wall_forces(slot); });
    if (colliders_.has_bodies()) sum_body_loads();
  }
  end_stage(StepStage::wall_forces);
}

template <int Dim, typename Real>
void Solver<Dim, Real>::apply_wall_forces(std::size_t slot) {
  const WallNeighbour<Dim>& wall = walls_->neighbours()[slot];
  if (wall.contacts.empty()) return;
  const auto i = static_cast<std::size_t>(wall.particle);
  Mat<Dim> corrected_stress = Mat<Dim>::Zero();
  if (terms_.pair.stress)
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) corrected_stress(a, b) = fields_.stress(i)[a * Dim + b];
  Vec<Dim> force = specific_force_[i].template cast<double>();
  for (const WallContact<Dim>& contact : wall.contacts) {
    const PlacedObstacle<Dim>& placed = colliders_.placed()[contact.obstacle];
    const Vec<Dim> a = contact_acceleration<Dim>(contact, placed.obstacle.response, particles_.density[i], pressure(i),
                                                 corrected_stress, wall_gradient_[slot], parameters_.gravity);
    force += a;
    if (placed.body) body_forces_[slot * colliders_.placed().size() + contact.obstacle] -= mass(i) * a;
  }
  specific_force_[i] = force.template cast<Real>();
}

/// What the fluid at walls does to rigid bodies, at the particles' places, so that body and fluid together keep their
/// angular momentum.
template <int Dim, typename Real>
void Solver<Dim, Real>::sum_body_loads() {
  const std::size_t n_obstacles = colliders_.placed().size();
  std::vector<Load<Dim>> loads(n_obstacles);
  for (std::size_t slot = 0; walls_ && slot < walls_->neighbours().size(); ++slot)
    for (std::size_t o = 0; o < n_obstacles; ++o) {
      if (!colliders_.placed()[o].body) continue;
      const Vec<Dim>& force = body_forces_[slot * n_obstacles + o];
      const Vec<Dim> arm = particles_.position[static_cast<std::size_t>(walls_->neighbours()[slot].particle)] -
                           colliders_.placed()[o].body->state.centre;
      loads[o].force += force;
      loads[o].torque += force * arm.transpose() - arm * force.transpose();
    }
  colliders_.set_body_loads(loads);
}

// ----------------------------------------------------------------------------------------------------------- leap-frog

template <int Dim, typename Real>
Vec<Dim> Solver<Dim, Real>::acceleration(std::size_t i) const {
  if (is_driven(i)) return Vec<Dim>::Zero();
  return specific_force_[i].template cast<double>() + parameters_.gravity;
}

template <int Dim, typename Real>
void Solver<Dim, Real>::kick(double dt) {
  parallel_for_each(particles_.size(), [&](std::size_t i) { particles_.velocity[i] += dt * acceleration(i); });
  if (terms_.gas)
    parallel_for_each(particles_.size(), [&](std::size_t i) { particles_.internal_energy[i] += dt * energy_rate_[i]; });
  if (colliders_.has_bodies()) colliders_.kick_bodies(parameters_.gravity, dt);
}

/// Past obstacles. Nothing is looked up while it cannot reach any: the same bytes, at no cost.
template <int Dim, typename Real>
void Solver<Dim, Real>::move_particle(std::size_t i, double radius, double dt, Vec<Dim>& transport,
                                      std::vector<BodyHit<Dim>>* hits) {
  const double reach = colliders_.reach(radius, dt, transport);
  if (clearance_[i] <= reach)
    clearance_[i] = round_down(colliders_.clearance(particles_.position[i], std::max(reach, 16.0 * radius)));
  if (clearance_[i] > reach) {
    clearance_[i] = round_down(clearance_[i] - (dt * transport.norm() + colliders_.step_way()));
    particles_.position[i] += dt * transport;
    return;
  }
  colliders_.move_sphere(radius, dt, particles_.position[i], transport, particles_.velocity[i], hits);
  clearance_[i] = 0.0F;
}

template <int Dim, typename Real>
Vec<Dim> Solver<Dim, Real>::mean_velocity() const {
  const Vec<Dim> sum = deterministic_reduce(
      particles_.size(), Vec<Dim>(Vec<Dim>::Zero()), [&](std::size_t i) { return particles_.velocity[i]; },
      [](const Vec<Dim>& a, const Vec<Dim>& b) { return Vec<Dim>(a + b); });
  return sum / static_cast<double>(particles_.size());
}

template <int Dim, typename Real>
void Solver<Dim, Real>::drift(double dt) {
  const double radius = particle_radius<Dim>(parameters_.particle_volume);
  const std::size_t n_blocks = (particles_.size() + block_size - 1) / block_size;
  if (n_blocks == 0) return;
  // What all particles do together brings none nearer to another. In a periodic box it takes them out of it, though.
  Vec<Dim> together = Vec<Dim>::Zero();
  if (!terms_.periodic) together = dt * mean_velocity();
  std::vector<double> farthest(n_blocks, 0.0);
  body_hits_.resize(colliders_.has_bodies() ? n_blocks : 0);
  parallel_blocks(
      n_blocks,
      [&](std::size_t block, std::size_t) {
        std::vector<ParticleHit<Dim>>* hits = colliders_.has_bodies() ? &body_hits_[block] : nullptr;
        if (hits) hits->clear();
        for (std::size_t i = block * block_size; i < std::min(particles_.size(), (block + 1) * block_size); ++i)
          farthest[block] = std::max(farthest[block], (drift_particle(i, radius, dt, hits) - together).norm());
      },
      1);
  step_way_ = *std::max_element(farthest.begin(), farthest.end());
  travelled_ += step_way_;
  travelled_at_surface_ += step_way_;
  // Walls do not come along.
  if (walls_) travelled_at_surface_ += together.norm() + colliders_.step_way();
}

/// Returns its way [m].
template <int Dim, typename Real>
Vec<Dim> Solver<Dim, Real>::drift_particle(std::size_t i, double radius, double dt,
                                           std::vector<ParticleHit<Dim>>* hits) {
  Vec<Dim>& velocity = particles_.velocity[i];
  // XSPH moves particles with a smoothed velocity and leaves the velocity itself alone  [Monaghan 1989].
  Vec<Dim> transport = velocity;
  if (terms_.pair.xsph && !is_driven(i)) transport += transport_[i].template cast<double>();
  const Vec<Dim> before = particles_.position[i];
  if (colliders_.empty() || is_driven(i)) {
    particles_.position[i] += dt * transport;
  } else {
    thread_local std::vector<BodyHit<Dim>> of_particle;
    of_particle.clear();
    move_particle(i, radius, dt, transport, hits ? &of_particle : nullptr);
    for (const BodyHit<Dim>& hit : of_particle) hits->push_back({static_cast<std::int32_t>(i), hit});
  }
  if (terms_.pair.xsph) transport_[i] = transport.template cast<Real>();
  const Vec<Dim> way = particles_.position[i] - before;
  if (walls_) walls_->travel(i, way.norm());
  return way;
}

/// The particles that hit a rigid body took it for infinitely heavy. All the hits of a step together are one inelastic
/// blow: each particle keeps the share 1/(1 + sum m K) of what it got, K the compliance of the body at each hit, at
/// most; and the body gets the opposite. However light the body, that neither overshoots nor loses momentum. The way of
/// the particles stays as it was: they changed no side.
template <int Dim, typename Real>
void Solver<Dim, Real>::strike_bodies() {
  std::vector<double> burden(colliders_.placed().size(), 0.0);
  for (const auto& block : body_hits_)
    for (const auto& [i, hit] : block)
      burden[hit.obstacle] +=
          mass(static_cast<std::size_t>(i)) * colliders_.placed()[hit.obstacle].body->compliance_bound(hit.place);
  for (const auto& block : body_hits_)
    for (const auto& [index, hit] : block) {
      const auto i = static_cast<std::size_t>(index);
      const double kept = 1.0 / (1.0 + burden[hit.obstacle]);
      particles_.velocity[i] -= (1.0 - kept) * hit.gain;
      colliders_.strike_body(hit.obstacle, particles_.position[i], -mass(i) * kept * hit.gain);
    }
}

template class Solver<3, float>;
template class Solver<3, double>;
template class Solver<2, double>;
template class Solver<1, double>;

}  // namespace smelt
